#include "light/light_io.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "core/atomic_file.h"
#include "core/error.h"

namespace glint {
namespace {

using nlohmann::json;
using nlohmann::ordered_json;

// What was found, for messages: a value as it is, what may be nested without end by its kind.
std::string Shown(const json& value) {
  if (value.is_object()) return "an object";
  if (!value.is_array()) return value.dump();
  const bool is_flat = std::none_of(value.begin(), value.end(), [](const json& part) { return part.is_structured(); });
  return is_flat && value.size() <= 16 ? value.dump() : fmt::format("a list of {}", value.size());
}

// One entry of the list, and how errors name it.
struct Record {
  const std::string& path;
  std::string name;
  const json& value;

  [[noreturn]] void Fail(std::string_view what) const { throw InputError(path, name, what); }

  const json& Require(const char* key) const {
    const auto it = value.find(key);
    if (it == value.end()) Fail(fmt::format("\"{}\" is missing", key));
    return *it;
  }

  std::string RequireOneOf(const char* key, std::string_view a, std::string_view b) const {
    const json& v = Require(key);
    if (!v.is_string() || (v != a && v != b))
      Fail(fmt::format("\"{}\" must be \"{}\" or \"{}\", found {}", key, a, b, Shown(v)));
    return v.get<std::string>();
  }

  Eigen::Vector3d RequireVector(const char* key) const {
    const json& v = Require(key);
    if (!v.is_array() || v.size() != 3)
      Fail(fmt::format("\"{}\" must be a list of 3 numbers, found {}", key, Shown(v)));
    Eigen::Vector3d vector;
    for (int i = 0; i < 3; ++i) {
      if (!v[i].is_number()) Fail(fmt::format("\"{}\" must be a list of 3 numbers, found {}", key, Shown(v)));
      vector[i] = v[i].get<double>();
    }
    if (!vector.allFinite()) Fail(fmt::format("\"{}\" must be finite, found {}", key, Shown(v)));
    return vector;
  }

  double OptionalNumber(const char* key) const {
    const auto it = value.find(key);
    if (it == value.end()) return 0;
    if (!it->is_number() || !std::isfinite(it->get<double>()) || it->get<double>() < 0)
      Fail(fmt::format("\"{}\" must be a number, zero or positive, found {}", key, Shown(*it)));
    return it->get<double>();
  }

  Eigen::Matrix3d OptionalCovariance() const {
    const auto it = value.find("covariance");
    if (it == value.end()) return Eigen::Matrix3d::Zero();
    std::array<double, 6> c{};
    bool sound = it->is_array() && it->size() == c.size();
    for (size_t i = 0; sound && i < c.size(); ++i) {
      sound = (*it)[i].is_number() && std::isfinite((*it)[i].get<double>());
      if (sound) c[i] = (*it)[i].get<double>();
    }
    if (!sound) Fail(fmt::format("\"covariance\" must be a list of 6 numbers, found {}", Shown(*it)));
    return (Eigen::Matrix3d() << c[0], c[1], c[2], c[1], c[3], c[4], c[2], c[4], c[5]).finished();
  }

  std::string OptionalText(const char* key) const {
    const auto it = value.find(key);
    if (it == value.end()) return "";
    if (!it->is_string()) Fail(fmt::format("\"{}\" must be a text, found {}", key, Shown(*it)));
    return it->get<std::string>();
  }

  std::vector<std::string> OptionalNames(const char* key) const {
    std::vector<std::string> names;
    const auto it = value.find(key);
    if (it == value.end()) return names;
    const bool sound = it->is_array() && !it->empty() &&
                       std::all_of(it->begin(), it->end(), [](const json& one) { return one.is_string(); });
    if (!sound) Fail(fmt::format("\"{}\" must be a list of at least one name, found {}", key, it->dump()));
    for (const json& one : *it) names.push_back(one.get<std::string>());
    return names;
  }

  void AllowOnly(std::initializer_list<std::string_view> keys) const {
    for (const auto& item : value.items()) {
      bool known = false;
      for (std::string_view key : keys) known |= item.key() == key;
      if (!known) Fail(fmt::format("unknown key \"{}\"; known here: {}", item.key(), fmt::join(keys, ", ")));
    }
  }
};

Light ParseLight(const Record& record) {
  if (!record.value.is_object()) record.Fail("expected an object, found " + Shown(record.value));
  Light light;
  light.type = record.RequireOneOf("type", "distant", "point") == "distant" ? LightType::kDistant : LightType::kPoint;
  light.frame = record.RequireOneOf("frame", "world", "camera") == "world" ? LightFrame::kWorld : LightFrame::kCamera;
  light.images = record.OptionalNames("images");
  if (light.type == LightType::kPoint) {
    record.AllowOnly({"type", "frame", "position", "sigma", "covariance", "support", "conditioning", "why", "images",
                      "angular_size_deg"});
    light.vector = record.RequireVector("position");
    light.sigma = record.OptionalNumber("sigma");
    return light;
  }
  record.AllowOnly({"type", "frame", "direction_to_light", "sigma_deg", "covariance", "support", "conditioning", "why",
                    "images", "angular_size_deg"});
  light.vector = record.RequireVector("direction_to_light");
  light.sigma = record.OptionalNumber("sigma_deg");
  const double length = light.vector.stableNorm();
  if (!(length > 0)) record.Fail("\"direction_to_light\" has zero length");
  light.vector = (light.vector / length).normalized();
  return light;
}

FoundLight ParseFoundLight(const Record& record, bool determined) {
  FoundLight found;
  found.light = ParseLight(record);
  found.covariance = record.OptionalCovariance();
  found.support = record.OptionalNumber("support");
  found.conditioning = record.OptionalNumber("conditioning");
  found.angular_size_deg = record.OptionalNumber("angular_size_deg");
  found.determined = determined;
  found.why = record.OptionalText("why");
  return found;
}

ordered_json ToJson(const Light& light) {
  const bool distant = light.type == LightType::kDistant;
  ordered_json out;
  out["type"] = distant ? "distant" : "point";
  out["frame"] = light.frame == LightFrame::kWorld ? "world" : "camera";
  out[distant ? "direction_to_light" : "position"] = {light.vector.x(), light.vector.y(), light.vector.z()};
  if (light.sigma > 0) out[distant ? "sigma_deg" : "sigma"] = light.sigma;
  if (!light.images.empty()) out["images"] = light.images;
  return out;
}

ordered_json ToJson(const FoundLight& found) {
  ordered_json out = ToJson(found.light);
  const Eigen::Matrix3d& c = found.covariance;
  if (!c.isZero()) out["covariance"] = {c(0, 0), c(0, 1), c(0, 2), c(1, 1), c(1, 2), c(2, 2)};
  if (found.support > 0) out["support"] = found.support;
  if (found.conditioning > 0) out["conditioning"] = found.conditioning;
  if (found.angular_size_deg > 0) out["angular_size_deg"] = found.angular_size_deg;
  if (!found.why.empty()) out["why"] = found.why;
  return out;
}

json Parse(const std::string& name) {
  std::ifstream file(name, std::ios::binary);
  if (!file) throw InputError(name, "", "cannot be read; expected a lights file (JSON)");
  json root;
  try {
    root = json::parse(file);
  } catch (const json::exception& e) {
    throw InputError(name, "", fmt::format("is not valid JSON: {}", e.what()));
  }
  for (const char* list : {"lights", "undetermined"}) {
    const bool missing = !root.is_object() || !root.contains(list);
    if ((missing && list == std::string_view("lights")) || (!missing && !root[list].is_array()))
      throw InputError(name, "", fmt::format("expected an object with a list \"{}\"", list));
  }
  Record{name, "", root}.AllowOnly({"lights", "undetermined"});
  return root;
}

}  // namespace

std::vector<FoundLight> ReadFoundLights(const std::filesystem::path& path) {
  const std::string name = path.string();
  const json root = Parse(name);
  std::vector<FoundLight> found;
  for (size_t i = 0; i < root["lights"].size(); ++i)
    found.push_back(ParseFoundLight({name, fmt::format("light {}", i), root["lights"][i]}, true));
  if (root.contains("undetermined"))
    for (size_t i = 0; i < root["undetermined"].size(); ++i)
      found.push_back(ParseFoundLight({name, fmt::format("undetermined {}", i), root["undetermined"][i]}, false));
  return found;
}

std::vector<Light> ReadLights(const std::filesystem::path& path) {
  std::vector<Light> lights;
  for (const FoundLight& found : ReadFoundLights(path))
    if (found.determined) lights.push_back(found.light);
  if (lights.empty()) throw InputError(path.string(), "lights", "the list is empty; expected at least one light");
  return lights;
}

void WriteFoundLights(const std::filesystem::path& path, const std::vector<FoundLight>& lights) {
  ordered_json root;
  root["lights"] = ordered_json::array();
  for (const FoundLight& found : lights) {
    ordered_json& list = root[found.determined ? "lights" : "undetermined"];
    list.push_back(ToJson(found));
  }
  WriteFileAtomically(path, root.dump(2) + "\n");
}

void WriteLights(const std::filesystem::path& path, const std::vector<Light>& lights) {
  std::vector<FoundLight> found;
  for (const Light& light : lights) found.emplace_back().light = light;
  WriteFoundLights(path, found);
}

}  // namespace glint
