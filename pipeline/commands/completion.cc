// glint completion: the script that makes a shell complete glint's command line.
#include "pipeline/completion.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "pipeline/commands/command.h"
#include "pipeline/config.h"
#include "pipeline/option_table.h"

namespace glint {
namespace {

using Kind = CompletionValue::Kind;

// From what the option takes as its help says it: "TEXT:{seed,detect}", "INT in [0 - 4096]", "TEXT", ...
CompletionValue ValueOf(const CLI::Option& option) {
  CompletionValue value;
  if (option.get_items_expected_max() == 0) return value;
  const std::string type = option.get_type_name();
  const size_t open = type.find('{'), close = type.rfind('}');
  if (open != std::string::npos && close != std::string::npos && open < close) {
    value.kind = Kind::kChoice;
    std::istringstream list(type.substr(open + 1, close - open - 1));
    for (std::string choice; std::getline(list, choice, ',');) value.choices.push_back(choice);
  } else {
    value.kind = type.starts_with("TEXT") ? Kind::kFile : Kind::kOther;
  }
  return value;
}

// --set takes any option of the configuration.
CompletionValue Settings() {
  Config config;
  CompletionValue value{Kind::kPrefix, {}};
  const OptionTable table(config);
  for (const OptionItem& item : table.items())
    if (item.kind == OptionItem::Kind::kField) value.choices.push_back(item.path + "=");
  return value;
}

CompletionCommand Describe(const CLI::App& app) {
  CompletionCommand command;
  command.name = app.get_name();
  command.help = app.get_description();
  for (const CLI::Option* option : app.get_options()) {
    if (!option->nonpositional()) {
      command.argument = ValueOf(*option);
      continue;
    }
    CompletionFlag flag;
    for (const std::string& name : option->get_snames()) flag.names.push_back("-" + name);
    for (const std::string& name : option->get_lnames()) flag.names.push_back("--" + name);
    flag.help = option->get_description();
    flag.value = option->check_lname("set") ? Settings() : ValueOf(*option);
    command.flags.push_back(std::move(flag));
  }
  return command;
}

std::string Script(const std::string& shell, const CLI::App& app) {
  std::vector<CompletionCommand> commands;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    commands.push_back(Describe(*command));
  if (shell == "bash") return BashCompletion(commands);
  return shell == "zsh" ? ZshCompletion(commands) : FishCompletion(commands);
}

}  // namespace

void AddCompletionCommand(CLI::App& app, CommandLine& line) {
  CLI::App* command =
      app.add_subcommand("completion", "Print the script that completes glint's command line in a shell");
  command->footer(
      "Switch it on by a line in the shell's own file:\n"
      "  ~/.bashrc                    source <(glint completion bash)\n"
      "  ~/.zshrc, after compinit     source <(glint completion zsh)\n"
      "  ~/.config/fish/config.fish   glint completion fish | source");
  auto shell = std::make_shared<std::string>();
  command->add_option("SHELL", *shell, "Which shell")->required()->check(CLI::IsMember({"bash", "zsh", "fish"}));
  command->callback(
      [shell, &app, &line] { line.action = [shell, &app](Terminal&) { fmt::print("{}", Script(*shell, app)); }; });
}

}  // namespace glint
