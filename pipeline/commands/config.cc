// glint config: the default configuration with comments, a resolved one, or the schema of them all.
#include "pipeline/config.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

#include "pipeline/commands/command.h"
#include "pipeline/config_schema.h"
#include "pipeline/option_table.h"

namespace glint {
namespace {

struct Arguments {
  std::string file;
  std::vector<std::string> settings;
  bool schema = false;
};

void Print(const Arguments& arguments) {
  Config config;
  if (arguments.schema) {
    fmt::print("{}", JsonSchema(OptionTable(config)));
  } else if (arguments.file.empty() && arguments.settings.empty()) {
    fmt::print("{}", DefaultConfigYaml());
  } else {
    fmt::print("{}", ConfigYaml(ResolveConfig(arguments.file, arguments.settings), "Resolved options."));
  }
}

}  // namespace

void AddConfigCommand(CLI::App& app, CommandLine& line) {
  CLI::App* command = app.add_subcommand("config", "Print the default configuration with comments");
  auto arguments = std::make_shared<Arguments>();
  command->add_option("--config", arguments->file, "Print this configuration, completed and checked, instead");
  command->add_option("--set", arguments->settings, "Change one option: section.option=value")->allow_extra_args(false);
  command->add_flag("--schema", arguments->schema, "Print the JSON Schema of configuration files, for editors");
  command->callback([arguments, &line] { line.action = [arguments](Terminal&) { Print(*arguments); }; });
}

}  // namespace glint
