// glint synth: a synthetic scene as a complete COLMAP project with its ground truth.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <memory>
#include <string>

#include "pipeline/commands/command.h"
#include "pipeline/commands/option_flags.h"
#include "pipeline/terminal.h"
#include "synthetic/synthesize.h"
#include "synthetic/write_project.h"

namespace glint {
namespace {

struct Arguments {
  std::string out;
  SyntheticOptions options;
  OptionTable table{options};
};

// "800x600".
std::string ParseSize(const std::string& text, SyntheticOptions& options) {
  const char* end = text.data() + text.size();
  const auto width = std::from_chars(text.data(), end, options.width);
  if (width.ec == std::errc() && width.ptr != end && (*width.ptr == 'x' || *width.ptr == 'X')) {
    const auto height = std::from_chars(width.ptr + 1, end, options.height);
    if (height.ec == std::errc() && height.ptr == end) return "";
  }
  return fmt::format("expected WIDTHxHEIGHT in pixels like 800x600, found \"{}\"", text);
}

}  // namespace

void AddSynthCommand(CLI::App& app, CommandLine& line) {
  CLI::App* command = app.add_subcommand("synth", "Render a synthetic scene: a COLMAP project with its ground truth");
  auto arguments = std::make_shared<Arguments>();
  const OptionItem* scene = arguments->table.FindField("scene");
  command->add_option("SCENE", arguments->options.scene, "What to render")
      ->required()
      ->type_name(fmt::format("{{{}}}", fmt::join(scene->choices, ",")));
  command->add_option("-o,--out", arguments->out, "Folder to write")->required();
  command
      ->add_option_function<std::string>(
          "--size",
          [arguments](const std::string& text) {
            const std::string problem = ParseSize(text, arguments->options);
            if (!problem.empty()) throw CLI::ValidationError("--size", problem);
          },
          "Of the images, WIDTHxHEIGHT in pixels")
      ->default_str(fmt::format("{}x{}", arguments->options.width, arguments->options.height));
  AddOptionFlags(*command, arguments->table, {"scene", "width", "height"});
  AddCommonOptions(*command, line);
  command->callback([arguments, &line] {
    line.action = [arguments](Terminal& terminal) {
      CheckOptions(arguments->options);
      WriteSyntheticProject(SynthesizeScene(arguments->options, terminal), arguments->out, terminal);
      terminal.Finish();
      terminal.Info(fmt::format("wrote {}: images, sparse/0, lights.json and truth", arguments->out));
    };
  });
}

}  // namespace glint
