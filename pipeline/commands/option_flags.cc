#include "pipeline/commands/option_flags.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <string>

namespace glint {
namespace {

std::string FlagName(std::string name) {
  std::replace_if(
      name.begin(), name.end(), [](char c) { return c == '_' || c == '.'; }, '-');
  return name;
}

std::string TypeName(const OptionItem& item) {
  if (std::holds_alternative<double*>(item.value)) return "NUMBER";
  if (std::holds_alternative<int*>(item.value)) return "INTEGER";
  if (!item.choices.empty()) return fmt::format("{{{}}}", fmt::join(item.choices, ","));
  return std::holds_alternative<std::string*>(item.value) ? "TEXT" : "[NUMBERS]";
}

void AddFlag(CLI::App& command, const OptionItem& item) {
  const std::string name = FlagName(item.path);
  const std::string constraint = DescribeConstraint(item);
  const std::string help = constraint.empty() ? item.help : fmt::format("{} ({})", item.help, constraint);
  if (const auto* flag = std::get_if<bool*>(&item.value)) {
    bool* value = *flag;
    command.add_flag_function(
        fmt::format("--{0},!--no-{0}", name), [value](std::int64_t count) { *value = count > 0; }, help);
    return;
  }
  const auto set = [item, name](const std::string& text) {
    if (!ParseValue(item, text))
      throw CLI::ValidationError("--" + name, fmt::format("expected {}, found \"{}\"", ExpectedValue(item), text));
  };
  command.add_option_function<std::string>("--" + name, set, help)
      ->default_str(FormatValue(item))
      ->type_name(TypeName(item));
}

}  // namespace

void AddOptionFlags(CLI::App& command, const OptionTable& table, std::initializer_list<std::string_view> except) {
  for (const OptionItem& item : table.items())
    if (item.kind == OptionItem::Kind::kField && std::count(except.begin(), except.end(), item.path) == 0)
      AddFlag(command, item);
}

}  // namespace glint
