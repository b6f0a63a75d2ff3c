#include "pipeline/summary_json.h"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/atomic_file.h"
#include "core/error.h"

namespace nlohmann {

// Small Eigen matrices as a flat list, column by column.
template <int Rows, int Cols>
struct adl_serializer<Eigen::Matrix<double, Rows, Cols>> {
  static void to_json(json& j, const Eigen::Matrix<double, Rows, Cols>& m) {
    j = json::array();
    for (int i = 0; i < m.size(); ++i) j.push_back(m.data()[i]);
  }
  static void from_json(const json& j, Eigen::Matrix<double, Rows, Cols>& m) {
    for (int i = 0; i < m.size(); ++i) m.data()[i] = j.at(i).get<double>();
  }
};

}  // namespace nlohmann

namespace glint {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Light, type, frame, vector, sigma)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(FoundLight, light, covariance, support, conditioning, normal_sigma_deg,
                                   criterion_gain, determined, why)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(FindLightsSummary, candidates, not_paint, normal_sigma_deg, outlier_share, lights)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(GateSummary, candidates, accepted, by_status, accepted_by_light,
                                   median_normal_error_deg, ambiguous_fraction)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(BundleLightUpdate, change, sigma, contacts)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(BundleSummary, num_contacts, num_chords, num_point_chords, num_rejected,
                                   initial_cost, final_cost, motion_rel, chord_rms_sigmas, lights, usable, message)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(StepSummary, energy_before, energy_after, solver_iterations, relative_residual,
                                   num_voxels, contacts_off_band, points_off_band)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(IterationSummary, voxel_rel, contacts_on_surface, contact_motion_voxels, bundle,
                                   step, seconds)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Material, num_patches, scatter, contrast, used)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(TiltSummary, materials, num_shaded, num_given_normals, normal_map_scatter_deg)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(RefineSummary, iterations, bends_like_seed, num_highlights, num_contacts, num_points,
                                   num_photo_points, tilts, converged, warnings)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Contact, highlight, view, light, origin, direction, depth, prior_depth,
                                   surface_normal, sigma_normal, sigma_depth, pixel_angle, axis_rays, accepted, reason)

namespace {

using Json = nlohmann::json;

// JSON has no infinities and no NaN: they become {"float": "inf"}.
void HideNonFinite(Json& json) {
  if (json.is_structured())
    for (Json& child : json) HideNonFinite(child);
  else if (json.is_number_float() && !std::isfinite(json.get<double>()))
    json = {{"float", fmt::format("{}", json.get<double>())}};
}

// What Glint writes is nested a few levels deep; what is deeper would run out of stack.
void ShowNonFinite(Json& json, int depth = 0) {
  constexpr int kMaxDepth = 32;
  if (depth > kMaxDepth) throw Json::other_error::create(599, "nested too deep", nullptr);
  if (json.is_object() && json.size() == 1 && json.contains("float") && json["float"].is_string())
    json = std::strtod(json["float"].get<std::string>().c_str(), nullptr);
  else if (json.is_structured())
    for (Json& child : json) ShowNonFinite(child, depth + 1);
}

std::string Dump(Json json) {
  HideNonFinite(json);
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Json Parse(const std::string& text) {
  Json json = Json::parse(text);
  ShowNonFinite(json);
  return json;
}

// Which stage fills which fields.
template <class Summary, class Field>
void VisitPart(RunStage stage, Summary& summary, const Field& field) {
  switch (stage) {
    case RunStage::kSeed:
      field("seed_report", summary.seed_report);
      break;
    case RunStage::kLights:
      field("find_lights", summary.find_lights);
      break;
    case RunStage::kGate:
      field("gate", summary.gate);
      break;
    case RunStage::kRefine:
      field("refine", summary.refine);
      field("lights", summary.lights);
      field("num_vertices", summary.num_vertices);
      field("num_faces", summary.num_faces);
      break;
    case RunStage::kPhotos:
    case RunStage::kDetect:
    case RunStage::kReport:
      break;
  }
}

}  // namespace

std::string SummaryPart(RunStage stage, const RunSummary& summary) {
  Json part = Json::object();
  VisitPart(stage, summary, [&](const char* name, const auto& value) { part[name] = value; });
  return Dump(std::move(part));
}

bool TakeSummaryPart(RunStage stage, const std::string& text, RunSummary& summary) {
  RunSummary taken = summary;
  try {
    const Json part = Parse(text);
    VisitPart(stage, taken, [&](const char* name, auto& value) { part.at(name).get_to(value); });
  } catch (const Json::exception&) {
    return false;
  }
  summary = std::move(taken);
  return true;
}

void WriteContacts(const std::filesystem::path& path, const std::vector<Contact>& contacts) {
  WriteFileAtomically(path, [&](std::ostream& out) {
    out << "[\n";
    for (size_t i = 0; i < contacts.size(); ++i) out << Dump(contacts[i]) << (i + 1 < contacts.size() ? ",\n" : "\n");
    out << "]\n";
  });
}

std::vector<Contact> ReadContacts(const std::filesystem::path& path, const Scene& scene, size_t num_highlights,
                                  size_t num_lights) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw InputError(path.string(), "", "missing; an earlier run leaves it");
  const std::string text(std::istreambuf_iterator<char>(in), {});
  try {
    auto contacts = Parse(text).get<std::vector<Contact>>();
    for (Contact& contact : contacts) {
      contact.cam_from_world = scene.views.at(contact.view).cam_from_world;
      if (contact.highlight >= num_highlights || contact.light < 0 || static_cast<size_t>(contact.light) >= num_lights)
        throw InputError(path.string(), "", "names a highlight or a light that is not there");
    }
    return contacts;
  } catch (const Json::exception& e) {
    throw InputError(path.string(), "", fmt::format("not as an earlier run wrote it: {}", e.what()));
  } catch (const std::out_of_range&) {
    throw InputError(path.string(), "", "names a view that the project does not have");
  }
}

}  // namespace glint
