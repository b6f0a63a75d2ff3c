#include "light/light_io.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

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
      Fail(fmt::format("\"{}\" must be \"{}\" or \"{}\", found {}", key, a, b, v.dump()));
    return v.get<std::string>();
  }

  Eigen::Vector3d RequireVector(const char* key) const {
    const json& v = Require(key);
    if (!v.is_array() || v.size() != 3)
      Fail(fmt::format("\"{}\" must be a list of 3 numbers, found {}", key, v.dump()));
    Eigen::Vector3d vector;
    for (int i = 0; i < 3; ++i) {
      if (!v[i].is_number()) Fail(fmt::format("\"{}\" must be a list of 3 numbers, found {}", key, v.dump()));
      vector[i] = v[i].get<double>();
    }
    if (!vector.allFinite()) Fail(fmt::format("\"{}\" must be finite, found {}", key, v.dump()));
    return vector;
  }

  double OptionalSigma(const char* key) const {
    const auto it = value.find(key);
    if (it == value.end()) return 0;
    if (!it->is_number() || !std::isfinite(it->get<double>()) || it->get<double>() < 0)
      Fail(fmt::format("\"{}\" must be a number, zero or positive, found {}", key, it->dump()));
    return it->get<double>();
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
  if (!record.value.is_object()) record.Fail("expected an object, found " + record.value.dump());
  Light light;
  light.type = record.RequireOneOf("type", "distant", "point") == "distant" ? LightType::kDistant : LightType::kPoint;
  light.frame = record.RequireOneOf("frame", "world", "camera") == "world" ? LightFrame::kWorld : LightFrame::kCamera;
  if (light.type == LightType::kPoint) {
    record.AllowOnly({"type", "frame", "position", "sigma"});
    light.vector = record.RequireVector("position");
    light.sigma = record.OptionalSigma("sigma");
    return light;
  }
  record.AllowOnly({"type", "frame", "direction_to_light", "sigma_deg"});
  light.vector = record.RequireVector("direction_to_light");
  light.sigma = record.OptionalSigma("sigma_deg");
  const double length = light.vector.stableNorm();
  if (!(length > 0)) record.Fail("\"direction_to_light\" has zero length");
  light.vector = (light.vector / length).normalized();
  return light;
}

ordered_json ToJson(const Light& light) {
  const bool distant = light.type == LightType::kDistant;
  ordered_json out;
  out["type"] = distant ? "distant" : "point";
  out["frame"] = light.frame == LightFrame::kWorld ? "world" : "camera";
  out[distant ? "direction_to_light" : "position"] = {light.vector.x(), light.vector.y(), light.vector.z()};
  if (light.sigma > 0) out[distant ? "sigma_deg" : "sigma"] = light.sigma;
  return out;
}

}  // namespace

std::vector<Light> ReadLights(const std::filesystem::path& path) {
  const std::string name = path.string();
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError(name, "", "cannot be read; expected a lights file (JSON)");
  json root;
  try {
    root = json::parse(file);
  } catch (const json::exception& e) {
    throw InputError(name, "", fmt::format("is not valid JSON: {}", e.what()));
  }
  if (!root.is_object() || !root.contains("lights") || !root["lights"].is_array())
    throw InputError(name, "", "expected an object with a list \"lights\"");
  Record{name, "", root}.AllowOnly({"lights"});
  if (root["lights"].empty()) throw InputError(name, "lights", "the list is empty; expected at least one light");
  std::vector<Light> lights;
  for (size_t i = 0; i < root["lights"].size(); ++i)
    lights.push_back(ParseLight({name, fmt::format("light {}", i), root["lights"][i]}));
  return lights;
}

void WriteLights(const std::filesystem::path& path, const std::vector<Light>& lights) {
  ordered_json list = ordered_json::array();
  for (const Light& light : lights) list.push_back(ToJson(light));
  ordered_json root;
  root["lights"] = list;
  WriteFileAtomically(path, root.dump(2) + "\n");
}

}  // namespace glint
