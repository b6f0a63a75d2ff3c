#include "pipeline/report.h"

#include <nlohmann/json.hpp>

#include "pipeline/versions.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

// As it is found from any folder.
std::string Whole(const std::filesystem::path& path) {
  std::error_code gone;  // the folder, while the run was on
  const std::filesystem::path whole = std::filesystem::absolute(path, gone).lexically_normal();
  return gone || path.empty() ? path.string() : whole.string();
}

Json ToJson(const Light& light) {
  const bool distant = light.type == LightType::kDistant;
  return {{"type", distant ? "distant" : "point"},
          {"frame", light.frame == LightFrame::kWorld ? "world" : "camera"},
          {distant ? "direction_to_light" : "position", {light.vector.x(), light.vector.y(), light.vector.z()}},
          {distant ? "sigma_deg" : "sigma", light.sigma}};
}

Json ToJson(const std::vector<Light>& lights) {
  Json json = Json::array();
  for (const Light& light : lights) json.push_back(ToJson(light));
  return json;
}

Json ToJson(const std::vector<FoundLight>& lights) {
  Json json = Json::array();
  for (const FoundLight& found : lights) {
    Json one = ToJson(found.light);
    one["support"] = found.support;
    one["determined"] = found.determined;
    if (found.normal_sigma_deg > 0) one["normal_sigma_deg"] = found.normal_sigma_deg;
    if (!found.why.empty()) one["why"] = found.why;
    json.push_back(one);
  }
  return json;
}

Json ToJson(const FindLightsSummary& find) {
  return {{"candidates", find.candidates},
          {"candidates_that_move", find.not_paint},
          {"outlier_share", find.outlier_share},
          {"lights", ToJson(find.lights)}};
}

Json ByStatus(const std::array<size_t, kNumHighlightStatuses>& counts) {
  Json json = Json::object();
  for (int s = 0; s < kNumHighlightStatuses; ++s)
    if (counts[s] > 0) json[std::string(StatusName(static_cast<HighlightStatus>(s)))] = counts[s];
  return json;
}

Json ToJson(const GateSummary& gate) {
  return {{"candidates", gate.candidates},
          {"accepted", gate.accepted},
          {"by_status", ByStatus(gate.by_status)},
          {"accepted_by_light", gate.accepted_by_light},
          {"median_normal_error_deg", gate.median_normal_error_deg},
          {"ambiguous_fraction", gate.ambiguous_fraction}};
}

Json ToJson(const BundleSummary& bundle) {
  Json json = {{"contacts", bundle.num_contacts},
               {"chords", bundle.num_chords},
               {"point_chords", bundle.num_point_chords},
               {"rejected", bundle.num_rejected},
               {"initial_cost", bundle.initial_cost},
               {"final_cost", bundle.final_cost},
               {"motion_rel", bundle.motion_rel},
               {"chord_rms_sigmas", bundle.chord_rms_sigmas},
               {"usable", bundle.usable},
               {"message", bundle.message}};
  json["lights"] = Json::array();
  for (const BundleLightUpdate& light : bundle.lights)
    json["lights"].push_back({{"change", light.change}, {"sigma", light.sigma}, {"contacts", light.contacts}});
  return json;
}

Json ToJson(const StepSummary& step) {
  return {{"voxels", step.num_voxels},
          {"energy_before", step.energy_before},
          {"energy_after", step.energy_after},
          {"solver_iterations", step.solver_iterations},
          {"relative_residual", step.relative_residual},
          {"contacts_off_band", step.contacts_off_band},
          {"points_off_band", step.points_off_band}};
}

Json ToJson(const RefineSummary& refine) {
  Json json = {{"bends_like_seed", refine.bends_like_seed},
               {"highlights", refine.num_highlights},
               {"contacts", refine.num_contacts},
               {"points", refine.num_points},
               {"photo_points", refine.num_photo_points},
               {"shaded_patches", refine.tilts.num_shaded},
               {"given_normals", refine.tilts.num_given_normals},
               {"normal_map_scatter_deg", refine.tilts.normal_map_scatter_deg},
               {"converged", refine.converged},
               {"warnings", refine.warnings}};
  json["materials"] = Json::array();
  for (const Material& material : refine.tilts.materials)
    json["materials"].push_back({{"patches", material.num_patches},
                                 {"scatter", material.scatter},
                                 {"contrast", material.contrast},
                                 {"used", material.used}});
  json["iterations"] = Json::array();
  for (const IterationSummary& iteration : refine.iterations)
    json["iterations"].push_back({{"voxel_rel", iteration.voxel_rel},
                                  {"contacts_on_surface", iteration.contacts_on_surface},
                                  {"contact_motion_voxels", iteration.contact_motion_voxels},
                                  {"bundle", ToJson(iteration.bundle)},
                                  {"level_set", ToJson(iteration.step)},
                                  {"seconds", iteration.seconds}});
  return json;
}

}  // namespace

std::string ReportJson(const RunSummary& summary) {
  Json json = {{"glint", GLINT_VERSION},     {"versions", Json::object()}, {"command", summary.command},
               {"outcome", summary.outcome}, {"notes", summary.notes},     {"warnings", summary.warnings}};
  std::error_code gone;  // the folder, while the run was on
  json["command_folder"] = std::filesystem::current_path(gone).string();
  for (const auto& [name, version] : LibraryVersions()) json["versions"][name] = version;
  if (!summary.colmap_version.empty()) json["versions"]["COLMAP"] = summary.colmap_version;
  json["project"] = {{"model", Whole(summary.model)}, {"images", Whole(summary.images)},
                     {"views", summary.num_views},    {"missing_images", summary.num_missing_images},
                     {"points", summary.num_points},  {"points_on_object", summary.num_points_used}};
  json["seed"] = {{"diagonal_world", summary.diagonal_world}, {"report", summary.seed_report}};
  json["highlights"] = {{"candidates", summary.num_candidates},
                        {"gate", ToJson(summary.gate)},
                        {"final_by_status", ByStatus(summary.highlights_by_status)}};
  json["lights"] = {{"given", ToJson(summary.lights_given)},
                    {"found", ToJson(summary.find_lights)},
                    {"refined", ToJson(summary.lights)}};
  json["refine"] = ToJson(summary.refine);
  json["mesh"] = {{"vertices", summary.num_vertices}, {"faces", summary.num_faces}};
  double total = 0;
  json["stages"] = Json::array();
  for (const StageTime& time : summary.times) {
    json["stages"].push_back({{"stage", time.stage}, {"reused", time.reused}, {"seconds", time.seconds}});
    if (!time.reused) total += time.seconds;
  }
  json["total_seconds"] = total;
  // Names of files need not be UTF-8; what is not is replaced, so that the report is valid JSON whatever they are.
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace glint
