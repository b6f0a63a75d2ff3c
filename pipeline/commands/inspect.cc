// glint inspect: what is this project, mesh or VDB, is it fit for use, what is missing.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "pipeline/commands/command.h"
#include "pipeline/inspection.h"
#include "pipeline/terminal.h"

namespace glint {

void AddInspectCommand(CLI::App& app, CommandLine& line) {
  CLI::App* command = app.add_subcommand("inspect", "What is this project, mesh or VDB, is it fit for use");
  auto arguments = std::make_shared<InspectArguments>();
  command->add_option("PATH", arguments->path, "A COLMAP project, a mesh or a .vdb file")->required();
  command->add_option("--images", arguments->images, "Folder of the images");
  command->add_option("--masks", arguments->masks, "Folder of the masks");
  command->add_flag("!--no-images", arguments->read_images, "Do not read the images, only look whether they are there");
  AddCommonOptions(*command, line);
  command->callback([arguments, &line] {
    line.action = [arguments](Terminal& terminal) {
      const Inspection inspection = Inspect(*arguments, terminal);
      terminal.Finish();
      fmt::print("{}", inspection.text);
    };
  });
}

}  // namespace glint
