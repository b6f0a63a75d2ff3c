#include "pipeline/config_schema.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <variant>
#include <vector>

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

void AddRange(const OptionItem& item, Json& schema) {
  if (std::isfinite(item.min)) schema["minimum"] = item.min;
  if (std::isfinite(item.max)) schema["maximum"] = item.max;
}

Json FieldSchema(const OptionItem& item) {
  Json schema;
  schema["description"] = item.unit.empty() ? item.help : item.help + " [" + item.unit + "]";
  if (const auto* number = std::get_if<double*>(&item.value)) {
    schema["type"] = "number";
    AddRange(item, schema);
    schema["default"] = **number;
  } else if (const auto* whole = std::get_if<int*>(&item.value)) {
    schema["type"] = "integer";
    AddRange(item, schema);
    schema["default"] = **whole;
  } else if (const auto* flag = std::get_if<bool*>(&item.value)) {
    schema["type"] = "boolean";
    schema["default"] = **flag;
  } else if (const auto* text = std::get_if<std::string*>(&item.value)) {
    schema["type"] = "string";
    if (!item.choices.empty()) schema["enum"] = item.choices;
    schema["default"] = **text;
  } else {
    schema["type"] = "array";
    schema["items"] = {{"type", "number"}};
    AddRange(item, schema["items"]);
    schema["default"] = **std::get_if<std::vector<double>*>(&item.value);
  }
  return schema;
}

// A section may also be empty: all its lines commented out.
Json SectionSchema(const std::string& help) {
  return {{"description", help},
          {"type", {"object", "null"}},
          {"additionalProperties", false},
          {"properties", Json::object()}};
}

}  // namespace

std::string JsonSchema(const OptionTable& table) {
  Json root = SectionSchema("Options of glint; those that are left out keep their defaults.");
  root["$schema"] = "http://json-schema.org/draft-07/schema#";
  root["title"] = "Glint's configuration";
  std::vector<Json> open = {root};
  std::vector<std::string> names;
  for (const OptionItem& item : table.items()) {
    if (item.kind == OptionItem::Kind::kBeginSection) {
      open.push_back(SectionSchema(item.help));
      names.push_back(item.name);
    } else if (item.kind == OptionItem::Kind::kField) {
      open.back()["properties"][item.name] = FieldSchema(item);
    } else {
      const Json section = std::move(open.back());
      open.pop_back();
      open.back()["properties"][names.back()] = section;
      names.pop_back();
    }
  }
  return open.front().dump(2) + "\n";
}

}  // namespace glint
