#include "pipeline/flow.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "core/atomic_file.h"
#include "core/error.h"
#include "highlights/check_lights.h"
#include "highlights/lamp_size.h"
#include "highlights/surface_colors.h"
#include "io/mesh_io.h"
#include "io/vdb_io.h"
#include "light/light_io.h"
#include "pipeline/artifacts.h"
#include "pipeline/image_stages.h"
#include "pipeline/memory.h"
#include "pipeline/outline_file.h"
#include "pipeline/photo_stage.h"
#include "pipeline/report.h"
#include "pipeline/report_page.h"
#include "pipeline/seed_stage.h"
#include "pipeline/summary_json.h"

namespace glint {

namespace fs = std::filesystem;

Flow::Flow(const RunArguments& arguments, const Config& config, RunLog& log)
    : arguments_(arguments), config_(config), log_(log), out_(arguments.out), stages_(out_, config, log) {}

void Flow::Note(const std::string& note) {
  summary_.notes.push_back(note);
  log_.Info(note);
}

void Flow::Prepare() {
  std::error_code missing;
  if (fs::equivalent(arguments_.project, out_.root(), missing))
    throw InputError(out_.root().string(), "", "is the project itself; expected another folder for the results");
  log_.WriteTo(out_.Log());
  summary_.command = arguments_.command;
  if (!arguments_.lights.empty()) lights_ = ReadLights(arguments_.lights);
  for (const Light& light : lights_) found_.emplace_back().light = light;
  summary_.lights_given = lights_;
  stages_.Give("lights", stages_.hashes().Of(arguments_.lights));
  stages_.Give("mesh", stages_.hashes().Of(arguments_.mesh));
}

// Where the project is that the run is about: as given, or made of photographs or a film.
ProjectPaths Flow::FindOrMakeProject() {
  if (arguments_.stages.from == RunStage::kPhotos) fs::remove_all(out_.Photographs());
  const PhotoStageResult photos =
      RunPhotoStage(arguments_.project, out_.Photographs(), out_.root(), config_.photos, log_);
  log_.Finish();
  for (const ReconstructStep& step : photos.steps)
    summary_.times.push_back({"colmap " + step.name, step.seconds, step.reused});
  summary_.colmap_version = photos.colmap_version;
  if (!photos.report.empty()) Note(photos.report);
  if (!photos.why_not.empty()) throw NoResultError(photos.why_not);  // there is nothing yet to report on
  return FindProject(photos.project, arguments_.images.empty() ? photos.images : arguments_.images,
                     arguments_.masks.empty() ? photos.masks : arguments_.masks);
}

void Flow::ReadProject() {
  const ProjectPaths paths = FindOrMakeProject();
  const auto start = std::chrono::steady_clock::now();
  for (const std::string& note : paths.notes) Note(note);
  const Model model = ReadModel(paths.model);
  for (const std::string& warning : model.warnings) log_.Warn(warning);
  scene_ = MakeScene(model);
  summary_.model = paths.model;
  summary_.images = paths.images;
  summary_.num_views = scene_.views.size();
  summary_.num_points = scene_.points.size();
  log_.Info(fmt::format("{}: {} images, {} points", paths.model.string(), scene_.views.size(), scene_.points.size()));
  images_ = std::make_unique<ProjectImages>(scene_, paths, log_);
  summary_.num_missing_images = images_->missing().size();
  if (!arguments_.normals.empty())
    normals_ = std::make_unique<NormalMapFiles>(scene_, arguments_.normals, config_.normals, log_);
  LookOver(paths);
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  summary_.times.push_back({"read", seconds.count(), false});
}

// What decides results, so that a later run knows whether it has changed.
void Flow::LookOver(const ProjectPaths& paths) {
  std::vector<std::string> files;
  for (const char* name : {"cameras", "images", "points3D", "rigs", "frames"})
    for (const char* extension : {".bin", ".txt"}) files.push_back(std::string(name) + extension);
  stages_.Give("model", stages_.hashes().Of(paths.model, files));
  std::vector<std::string> images, masks;
  for (const View& view : scene_.views) {
    images.push_back(view.name);
    masks.push_back(view.name + ".png");
  }
  std::string hash = stages_.hashes().Of(paths.images, images);
  if (images_->has_masks()) hash += stages_.hashes().Of(paths.masks, masks);
  stages_.Give("images", hash);
  stages_.Give("normals", normals_ ? stages_.hashes().Of(arguments_.normals, normals_->Names()) : "");
}

void Flow::MakeSeed() {
  if (scene_.points.empty() && arguments_.mesh.empty())
    throw InputError(summary_.model.string(), "points3D",
                     "expected sparse points, found none; or give a mesh with --mesh");
  const SeedStageResult seed = RunSeedStage(scene_, *images_, arguments_.mesh, config_, log_);
  for (const std::string& note : seed.notes) Note(note);
  for (const std::string& warning : seed.warnings) log_.Warn(warning);
  summary_.seed_report = seed.report;
  log_.Finish();
  log_.Info(seed.report);
  if (!seed.points.vertices.empty()) WriteMesh(out_.Points(), seed.points);
  if (seed.start.empty()) GiveUp("no seed: the sparse points enclose no object; give a mesh with --mesh");
  WriteMesh(out_.Seed(), seed.mesh);
  WriteMesh(out_.Start(), seed.start);
  WriteFlags(out_.PointsOnObject(), seed.point_used);
  WriteOutline(out_.Outline(), seed.outline);
}

void Flow::TakeSeed() {
  seed_ = ReadMesh(out_.Start());
  summary_.diagonal_world = Diagonal(seed_);
  point_used_ = ReadFlags(out_.PointsOnObject(), scene_.points.size());
  outline_ = ReadOutline(out_.Outline(), scene_.views.size());
  summary_.num_points_used = point_used_.size() - std::count(point_used_.begin(), point_used_.end(), 0);
  CheckRefineMemory(seed_, config_.refine, config_.output.memory_fraction);
}

void Flow::Detect() { WriteHighlights(out_.Candidates(), DetectInAllViews(scene_, *images_, config_.detect, log_)); }

void Flow::TakeHighlights(const fs::path& file) {
  highlights_ = ReadHighlights(file, scene_.views.size(), lights_.size());
}

void Flow::FindLightsIfUnknown() {
  for (size_t k = 0; k < lights_.size(); ++k)
    if (InsideObject(lights_[k], seed_))
      throw InputError(arguments_.lights.string(), fmt::format("light {}", k), "lies inside the object");
  const std::vector<FoundLight> found =
      FindLights(scene_, *images_, seed_, config_.gate, config_.lights, highlights_, &summary_.find_lights, log_);
  log_.Finish();
  if (lights_.empty()) {
    WriteFoundLights(out_.StageLights(), found);
    log_.Info(summary_.find_lights.BriefReport());
    if (!summary_.find_lights.mirror_like.empty()) GiveUp(summary_.find_lights.mirror_like);
    return;
  }
  WriteLights(out_.StageLights(), lights_);
  if (!summary_.find_lights.mirror_like.empty()) log_.Warn(summary_.find_lights.mirror_like);
  for (const std::string& sentence : Contradictions(lights_, found, scene_.views, BoundingBox(seed_).center()))
    log_.Warn(sentence);
}

// The lights given, or those that were found.
void Flow::TakeLights() {
  if (lights_.empty()) {
    found_ = ReadFoundLights(out_.StageLights());
    for (const FoundLight& found : found_)
      if (found.determined) lights_.push_back(found.light);
  }
  summary_.lights = found_;
  if (!lights_.empty()) return;
  if (highlights_.empty()) GiveUp("no highlights found in any image");
  std::string why =
      fmt::format("{} candidate highlights determine no light; give the lights with --lights FILE", highlights_.size());
  for (const FoundLight& found : found_) why += fmt::format("; of one, {}", found.why);
  GiveUp(why);
}

void Flow::Gate() {
  GateHighlights(scene_, *images_, seed_, lights_, config_.gate, highlights_, &summary_.gate, log_);
  WriteHighlights(out_.Gated(), highlights_);
  log_.Finish();
  log_.Info(summary_.gate.BriefReport());
}

void Flow::TakeGated() {
  TakeHighlights(out_.Gated());
  const auto accepted = std::count_if(highlights_.begin(), highlights_.end(),
                                      [](const Highlight& h) { return h.status == HighlightStatus::kAccepted; });
  if (highlights_.empty()) GiveUp("no highlights found in any image");
  if (accepted == 0) GiveUp(fmt::format("none of the {} candidates is a highlight of the lights", highlights_.size()));
}

void Flow::RefineSurface() {
  const RefineResult refined =
      Refine({scene_, seed_, point_used_, highlights_, lights_, outline_, images_.get(), normals_.get()},
             config_.refine, log_);
  log_.Finish();
  for (const std::string& warning : refined.summary.warnings) log_.Warn(warning);
  if (refined.summary.num_photo_points > 0)
    Note(fmt::format("texture shows the surface in {} places", refined.summary.num_photo_points));
  if (const std::string said = refined.summary.tilts.BriefReport(); !said.empty()) Note(said);
  TakeRefinedLights(refined);
  summary_.refine = refined.summary;
  summary_.num_vertices = refined.mesh.vertices.size();
  summary_.num_faces = refined.mesh.faces.size();

  // From here on the folder holds this run's results; an earlier report does not belong to them.
  Publication files(out_);
  WriteHighlights(files.For(out_.Refined()), refined.highlights);
  WriteContacts(files.For(out_.Contacts()), refined.contacts);
  WriteFoundLights(files.For(out_.Lights()), found_);
  WriteFileAtomically(files.For(out_.Config()), ConfigYaml(config_, "The options of this run, as resolved."));
  if (refined.level_set.empty())
    files.Remove(out_.LevelSetFile());
  else
    WriteVdb(files.For(out_.LevelSetFile()), refined.level_set);
  TriangleMesh mesh = refined.mesh;
  mesh.colors = ColorSurface(mesh, scene_, *images_, refined.highlights, {}, log_).rgb;
  WriteMesh(files.For(out_.Mesh()), mesh);
  for (const fs::path& file : {out_.Report(), out_.ReportPage(), out_.MeshAs(".obj"), out_.MeshAs(".glb")})
    files.Remove(file);
  files.Publish();
}

// The bundle says where a light is, but too boldly how well that is known: its chords share the errors of the surface's
// normals and count as independent. So a standard deviation never falls below what the votes said. A light that was not
// solved for stays as it was given. That the middle of an extended lamp is known less well than its highlights' the
// bundle does not know.
void Flow::TakeRefinedLights(const RefineResult& refined) {
  for (size_t k = 0; k < refined.lights.size(); ++k) {
    FoundLight& found = found_[k];
    found.light = refined.lights[k];
    if (refined.summary.iterations.empty() || refined.summary.iterations.back().bundle.lights.size() <= k) continue;
    const BundleLightUpdate& update = refined.summary.iterations.back().bundle.lights[k];
    found.support = update.contacts;
    if (update.sigma <= 0) continue;
    const double solved = update.sigma * (found.light.type == LightType::kPoint ? summary_.diagonal_world : 1);
    const double sigma = std::hypot(solved, CentroidSigma(scene_.views, BoundingBox(seed_).center(), found));
    if (sigma <= found.light.sigma) continue;
    found.light.sigma = sigma;
    found.covariance *= 0;
  }
  summary_.lights = found_;
}

void Flow::TakeRefined() {
  TakeHighlights(out_.Refined());
  refined_.mesh = ReadMesh(out_.Mesh());
  for (const FoundLight& found : ReadFoundLights(out_.Lights()))
    if (found.determined) refined_.lights.push_back(found.light);
  refined_.contacts = ReadContacts(out_.Contacts(), scene_, highlights_.size(), refined_.lights.size());
  refined_.summary = summary_.refine;
}

std::vector<fs::path> Flow::Reports() const {
  std::vector<fs::path> files = {out_.Report(), out_.ReportPage(), out_.Config()};
  if (config_.output.overlays)
    for (const View& view : scene_.views) files.push_back(PathForImage(out_.Overlays(), view.name, ".png"));
  if (config_.output.highlight_masks)
    for (const View& view : scene_.views) files.push_back(PathForImage(out_.HighlightMasks(), view.name, ".png"));
  if (config_.output.obj) files.push_back(out_.MeshAs(".obj"));
  if (config_.output.glb) files.push_back(out_.MeshAs(".glb"));
  return files;
}

void Flow::Report(const std::string& outcome) {
  for (const Highlight& h : highlights_) ++summary_.highlights_by_status[static_cast<size_t>(h.status)];
  summary_.num_candidates = highlights_.size();
  if (config_.output.overlays && !highlights_.empty())
    WriteOverlays(scene_, *images_, highlights_, config_.output.overlay_max_side_px, out_.Overlays(), log_);
  if (config_.output.highlight_masks && !highlights_.empty())
    WriteHighlightMasks(scene_, highlights_, out_.HighlightMasks(), log_);
  if (config_.output.obj && !refined_.mesh.empty()) WriteMesh(out_.MeshAs(".obj"), refined_.mesh);
  if (config_.output.glb && !refined_.mesh.empty()) WriteMesh(out_.MeshAs(".glb"), refined_.mesh);
  log_.Finish();
  summary_.outcome = outcome;
  summary_.warnings = log_.Warnings();
  WriteFileAtomically(out_.Config(), ConfigYaml(config_, "The options of this run, as resolved."));
  refined_.highlights = highlights_;
  const TriangleMesh seed = summary_.diagonal_world > 0 ? ReadMesh(out_.Seed()) : TriangleMesh();
  WriteFileAtomically(out_.ReportPage(), ReportPage({summary_, config_, scene_, *images_, seed, refined_}, log_));
  WriteFileAtomically(out_.Report(), ReportJson(summary_));
}

void Flow::GiveUp(const std::string& why) {
  const bool earlier = out_.SetEarlierResultsAside({arguments_.lights, arguments_.mesh, arguments_.config});
  Report(why);
  throw NoResultError(fmt::format("{}; what was found is in {}{}", why, out_.root().string(),
                                  earlier ? ", the results of the earlier run are in its folder earlier/" : ""));
}

}  // namespace glint
