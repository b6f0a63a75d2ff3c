// glint run: the main job.
#include "pipeline/run.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "pipeline/commands/command.h"
#include "pipeline/config.h"
#include "pipeline/terminal.h"

namespace glint {
namespace {

struct Arguments {
  RunArguments run;
  std::string from{kRunStageNames[0]};
  std::vector<std::string> settings;
};

}  // namespace

void AddRunCommand(CLI::App& app, CommandLine& line) {
  CLI::App* command = app.add_subcommand("run", "The main job: a COLMAP project in, a better mesh out");
  auto arguments = std::make_shared<Arguments>();
  command->add_option("PROJECT", arguments->run.project, "Folder of a COLMAP project")->required();
  command->add_option("-o,--out", arguments->run.out, "Folder for the results")->required();
  command->add_option("--config", arguments->run.config, "YAML file with options to change (see glint config)");
  command->add_option("--set", arguments->settings, "Change one option: section.option=value")->allow_extra_args(false);
  command->add_option("--lights", arguments->run.lights, "JSON file with the lights");
  command->add_option("--mesh", arguments->run.mesh,
                      "Start from this mesh, in the project's frame, not from the points");
  command->add_option("--images", arguments->run.images, "Folder of the images, if not in the project");
  command->add_option("--masks", arguments->run.masks,
                      "Folder of masks (IMAGE.png, 0 is ignored), if not in the project");
  command->add_option("--from", arguments->from, "Go on from this stage of the earlier run in OUT")
      ->check(CLI::IsMember(std::vector<std::string>(kRunStageNames.begin(), kRunStageNames.end())))
      ->capture_default_str();
  AddCommonOptions(*command, line);
  command->callback([arguments, &line] {
    line.action = [arguments, &line](Terminal& terminal) {
      const Config config = ResolveConfig(arguments->run.config, arguments->settings);
      const auto from = std::find(kRunStageNames.begin(), kRunStageNames.end(), arguments->from);
      arguments->run.from = static_cast<RunStage>(from - kRunStageNames.begin());
      arguments->run.command = line.text;
      const RunSummary summary = Run(arguments->run, config, terminal);
      terminal.Info(
          fmt::format("{}: mesh.ply ({} faces), sdf.vdb, report.json", arguments->run.out.string(), summary.num_faces));
    };
  });
}

}  // namespace glint
