#include "pipeline/artifacts.h"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <string>

#include "core/atomic_file.h"
#include "core/error.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

std::string ReadText(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::stringstream text;
  if (!std::filesystem::is_regular_file(path) || !in)
    throw InputError(path.string(), "", "missing; an earlier run leaves it, expected when starting from a later stage");
  text << in.rdbuf();
  return text.str();
}

Json SymmetricToJson(const Eigen::Matrix2d& m) { return {m(0, 0), m(0, 1), m(1, 1)}; }

double Number(const Json& value) {
  const double number = value.get<double>();
  if (!std::isfinite(number)) throw std::domain_error("a number is not finite");
  return number;
}

Eigen::Matrix2d SymmetricFromJson(const Json& m) {
  return (Eigen::Matrix2d() << Number(m.at(0)), Number(m.at(1)), Number(m.at(1)), Number(m.at(2))).finished();
}

HighlightStatus StatusFromName(const std::string& name) {
  for (int s = 0; s < kNumHighlightStatuses; ++s)
    if (StatusName(static_cast<HighlightStatus>(s)) == name) return static_cast<HighlightStatus>(s);
  throw std::domain_error("unknown status \"" + name + "\"");
}

Json ToJson(const Highlight& h) {
  return {{"view", h.view},
          {"px", {h.px.x(), h.px.y()}},
          {"covariance_px", SymmetricToJson(h.covariance_px)},
          {"moments_px", SymmetricToJson(h.moments_px)},
          {"area_px", h.area_px},
          {"strength", h.strength},
          {"saturated_fraction", h.saturated_fraction},
          {"flatness", h.flatness},
          {"light", h.light},
          {"status", StatusName(h.status)}};
}

// A whole number in [min, end); the library's own conversion wraps what does not fit.
int64_t Index(const Json& value, const char* kind, int64_t min, size_t end) {
  if (!value.is_number_integer()) throw std::domain_error(fmt::format("{} is not a whole number", kind));
  const bool is_huge = value.is_number_unsigned() && value.get<uint64_t>() >= end;
  const int64_t index = is_huge ? 0 : value.get<int64_t>();
  if (is_huge || index < min || (index >= 0 && static_cast<uint64_t>(index) >= end))
    throw std::domain_error(fmt::format("{} {} of {}", kind, value.dump(), end));
  return index;
}

Highlight FromJson(const Json& json, size_t num_views, size_t num_lights) {
  Highlight h;
  h.view = static_cast<uint32_t>(Index(json.at("view"), "view", 0, num_views));
  h.px = {Number(json.at("px").at(0)), Number(json.at("px").at(1))};
  h.covariance_px = SymmetricFromJson(json.at("covariance_px"));
  h.moments_px = SymmetricFromJson(json.at("moments_px"));
  h.area_px = Number(json.at("area_px"));
  h.strength = Number(json.at("strength"));
  h.saturated_fraction = Number(json.at("saturated_fraction"));
  h.flatness = json.contains("flatness") ? Number(json.at("flatness")) : 0;
  h.light = static_cast<int>(Index(json.at("light"), "light", -1, num_lights));
  h.status = StatusFromName(json.at("status").get<std::string>());
  return h;
}

}  // namespace

void WriteHighlights(const std::filesystem::path& path, const std::vector<Highlight>& highlights) {
  WriteFileAtomically(path, [&](std::ostream& out) {
    out << "{\"highlights\": [\n";
    for (size_t i = 0; i < highlights.size(); ++i)
      out << ToJson(highlights[i]).dump() << (i + 1 < highlights.size() ? ",\n" : "\n");
    out << "]}\n";
  });
}

std::vector<Highlight> ReadHighlights(const std::filesystem::path& path, size_t num_views, size_t num_lights) {
  std::vector<Highlight> highlights;
  std::string record = "the file";
  try {
    const Json root = Json::parse(ReadText(path));
    for (const Json& entry : root.at("highlights")) {
      record = fmt::format("highlight {}", highlights.size());
      highlights.push_back(FromJson(entry, num_views, num_lights));
    }
  } catch (const Json::exception& e) {
    throw InputError(path.string(), record, fmt::format("not as an earlier run wrote it: {}", e.what()));
  } catch (const std::domain_error& e) {
    throw InputError(path.string(), record, fmt::format("not as an earlier run wrote it: {}", e.what()));
  }
  return highlights;
}

void WriteFlags(const std::filesystem::path& path, const std::vector<uint8_t>& flags) {
  std::string text;
  text.reserve(flags.size() + 1);
  for (uint8_t flag : flags) text += flag ? '1' : '0';
  WriteFileAtomically(path, text + "\n");
}

std::vector<uint8_t> ReadFlags(const std::filesystem::path& path, size_t count) {
  const std::string text = ReadText(path);
  if (text.size() != count + 1 || text.find_first_not_of("01") != count || text.back() != '\n')
    throw InputError(path.string(), "",
                     fmt::format("expected {} digits 0 or 1; was it left by another project?", count));
  std::vector<uint8_t> flags(count);
  for (size_t i = 0; i < count; ++i) flags[i] = text[i] == '1';
  return flags;
}

}  // namespace glint
