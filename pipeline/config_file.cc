#include "pipeline/config_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <yaml-cpp/yaml.h>

#include <fstream>
#include <optional>
#include <set>
#include <sstream>

#include "core/error.h"

namespace glint {
namespace {

constexpr size_t kLineWidth = 120;

std::string UnknownOption(const OptionTable& table, const std::string& path) {
  return fmt::format("{}: unknown option; the nearest is {}", path, table.Nearest(path));
}

class YamlReader {
 public:
  YamlReader(const std::string& file, const OptionTable& table, ConfigProblems& problems)
      : file_(file), table_(table), problems_(problems) {}

  void ReadSection(const YAML::Node& node, const std::string& section) {
    std::set<std::string> seen;
    for (const auto& pair : node) {
      const std::string where = fmt::format("{}:{}", file_, pair.first.Mark().line + 1);
      if (!pair.first.IsScalar()) {
        problems_.messages.push_back(fmt::format("{}: expected a key, found a list or map", where));
        continue;
      }
      const std::string key = pair.first.Scalar();
      const std::string path = section.empty() ? key : fmt::format("{}.{}", section, key);
      if (!seen.insert(key).second) problems_.messages.push_back(fmt::format("{}: {}: given twice", where, path));
      ReadValue(pair.second, path, where);
    }
  }

 private:
  void ReadValue(const YAML::Node& node, const std::string& path, const std::string& where) {
    if (const OptionItem* field = table_.FindField(path)) {
      problems_.origin[path] = where;
      const std::optional<std::string> text = TextOf(node, *field);
      if (!text || !ParseValue(*field, *text))
        problems_.messages.push_back(fmt::format("{}: {}: expected {}, found {}", where, path, ExpectedValue(*field),
                                                 node.IsScalar() ? "\"" + node.Scalar() + "\"" : KindOf(node)));
    } else if (!table_.FindSection(path)) {
      problems_.messages.push_back(fmt::format("{}: {}", where, UnknownOption(table_, path)));
    } else if (node.IsMap()) {
      ReadSection(node, path);
    } else if (!node.IsNull()) {  // a section whose every line is commented out is empty, not wrong
      problems_.messages.push_back(
          fmt::format("{}: {}: expected a section of options, found {}", where, path, KindOf(node)));
    }
  }

  // The value as one text for ParseValue; nullopt where the node's kind does not suit the field.
  static std::optional<std::string> TextOf(const YAML::Node& node, const OptionItem& field) {
    if (node.IsScalar()) return node.Scalar();
    if (!node.IsSequence() || !std::holds_alternative<std::vector<double>*>(field.value)) return std::nullopt;
    std::vector<std::string> parts;
    for (const YAML::Node& part : node) parts.push_back(part.IsScalar() ? part.Scalar() : "?");
    return fmt::format("[{}]", fmt::join(parts, ", "));
  }

  static std::string KindOf(const YAML::Node& node) {
    if (node.IsSequence()) return "a list";
    if (node.IsMap()) return "a section";
    return node.IsNull() ? "nothing" : "\"" + node.Scalar() + "\"";
  }

  const std::string& file_;
  const OptionTable& table_;
  ConfigProblems& problems_;
};

// Appends `text` as comment lines of at most kLineWidth columns.
void AppendComment(std::string& out, const std::string& indent, const std::string& text) {
  std::istringstream words(text);
  std::string line = indent + "#", word;
  while (words >> word) {
    if (line.size() + 1 + word.size() > kLineWidth) {
      out += line + "\n";
      line = indent + "#";
    }
    line += " " + word;
  }
  out += line + "\n";
}

}  // namespace

void ConfigProblems::ThrowIfAny() const {
  if (!messages.empty()) throw InputError("", "", fmt::format("{}", fmt::join(messages, "\n")));
}

void ReadYamlFile(const std::filesystem::path& file, const OptionTable& table, ConfigProblems& problems) {
  std::ifstream in(file, std::ios::binary);
  std::stringstream text;
  if (!std::filesystem::is_regular_file(file) || !in || !(text << in.rdbuf() || text.str().empty()))
    throw InputError(file.string(), "", "cannot be read; expected a YAML configuration file");
  try {
    const YAML::Node root = YAML::Load(text.str());
    if (root.IsNull()) return;
    if (!root.IsMap())
      throw InputError(file.string(), "", "expected sections of options, found a list or a bare value");
    YamlReader(file.string(), table, problems).ReadSection(root, "");
  } catch (const YAML::Exception& e) {
    throw InputError(fmt::format("{}:{}", file.string(), e.mark.line + 1), "", "not valid YAML: " + e.msg);
  }
}

void ApplySetting(const std::string& setting, const OptionTable& table, ConfigProblems& problems) {
  const size_t equals = setting.find('=');
  if (equals == std::string::npos || equals == 0) {
    problems.messages.push_back(fmt::format("--set {}: expected key=value", setting));
    return;
  }
  const std::string path = setting.substr(0, equals), value = setting.substr(equals + 1);
  const OptionItem* field = table.FindField(path);
  if (!field) {
    problems.messages.push_back(table.FindSection(path)
                                    ? fmt::format("--set: {}: is a section; expected one of its options", path)
                                    : "--set: " + UnknownOption(table, path));
  } else if (!ParseValue(*field, value)) {
    problems.messages.push_back(
        fmt::format("--set: {}: expected {}, found \"{}\"", path, ExpectedValue(*field), value));
  }
  problems.origin[path] = "--set";
}

std::string WriteYaml(const OptionTable& table, const std::string& title) {
  std::string out;
  AppendComment(out, "", title);
  std::string indent;
  for (const OptionItem& item : table.items()) {
    switch (item.kind) {
      case OptionItem::Kind::kBeginSection:
        out += "\n";
        AppendComment(out, indent, item.help);
        out += indent + item.name + ":\n";
        indent += "  ";
        break;
      case OptionItem::Kind::kEndSection:
        indent.resize(indent.size() - 2);
        break;
      case OptionItem::Kind::kField: {
        const std::string constraint = DescribeConstraint(item);
        AppendComment(out, indent, constraint.empty() ? item.help : fmt::format("{} ({})", item.help, constraint));
        out += fmt::format("{}{}: {}\n", indent, item.name, FormatValue(item));
        break;
      }
    }
  }
  return out;
}

}  // namespace glint
