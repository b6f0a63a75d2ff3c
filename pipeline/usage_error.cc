#include "pipeline/usage_error.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <functional>
#include <string_view>

#include "pipeline/edit_distance.h"

namespace glint {
namespace {

constexpr size_t kMaxLength = 200;  // no name is as long, and the work grows with the length

std::string Nearest(std::string_view word, const std::vector<std::string>& names) {
  word = word.substr(0, kMaxLength);
  return *std::min_element(names.begin(), names.end(), [&](const std::string& a, const std::string& b) {
    return EditDistance(word, a) < EditDistance(word, b);
  });
}

// Without the value that follows an equals sign; empty for what is no flag, such as a negative number.
std::string FlagIn(const std::string& argument) {
  const bool flag = argument.size() > 1 && argument[0] == '-' &&
                    std::string_view(".0123456789").find(argument[1]) == std::string_view::npos;
  return flag ? argument.substr(0, argument.find('=')) : "";
}

// A line for each flag of the arguments that the command does not know.
std::string UnknownFlags(const CLI::App& command, const std::vector<std::string>& arguments) {
  std::vector<std::string> known;
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) known.push_back("--" + name);
    for (const std::string& name : option->get_snames()) known.push_back("-" + name);
  }
  std::string lines;
  for (const std::string& argument : arguments) {
    const std::string flag = FlagIn(argument);
    if (flag.empty() || std::count(known.begin(), known.end(), flag)) continue;
    if (flag[1] != '-' && std::count(known.begin(), known.end(), flag.substr(0, 2))) continue;  // -oFILE
    lines += fmt::format("{}error: {}: unknown flag; the nearest is {}", lines.empty() ? "" : "\n", flag,
                         Nearest(flag, known));
  }
  return lines;
}

}  // namespace

std::string DescribeUsageError(const CLI::App& app, const CLI::Error& error,
                               const std::vector<std::string>& arguments) {
  if (arguments.empty()) return app.help();
  std::vector<std::string> commands;
  const CLI::App* command = nullptr;
  for (const CLI::App* known : app.get_subcommands(std::function<bool(const CLI::App*)>())) {
    commands.push_back(known->get_name());
    if (known->get_name() == arguments.front()) command = known;
  }
  if (!command && FlagIn(arguments.front()).empty())
    return fmt::format("error: {}: unknown command; the nearest is {}\nglint --help lists all\n", arguments.front(),
                       Nearest(arguments.front(), commands));
  const bool unexpected = dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr;
  std::string lines = unexpected || !command ? UnknownFlags(command ? *command : app, arguments) : "";
  if (lines.empty()) lines = fmt::format("error: {}", error.what());
  return fmt::format("{}\nglint {}{}--help tells more\n", lines, command ? command->get_name() : "",
                     command ? " " : "");
}

}  // namespace glint
