// glint config: the default configuration with comments, or a resolved one.
#include "pipeline/config.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

#include "pipeline/commands/command.h"

namespace glint {
namespace {

struct Arguments {
  std::string file;
  std::vector<std::string> settings;
};

}  // namespace

void AddConfigCommand(CLI::App& app, CommandLine& line) {
  CLI::App* command = app.add_subcommand("config", "Print the default configuration with comments");
  auto arguments = std::make_shared<Arguments>();
  command->add_option("--config", arguments->file, "Print this configuration, completed and checked, instead");
  command->add_option("--set", arguments->settings, "Change one option: section.option=value")->allow_extra_args(false);
  command->callback([arguments, &line] {
    line.action = [arguments](Terminal&) {
      const bool resolved = !arguments->file.empty() || !arguments->settings.empty();
      fmt::print("{}", resolved ? ConfigYaml(ResolveConfig(arguments->file, arguments->settings), "Resolved options.")
                                : DefaultConfigYaml());
    };
  });
}

}  // namespace glint
