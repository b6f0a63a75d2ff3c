#include "pipeline/run.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <memory>

#include "colmap/project.h"
#include "colmap/scene.h"
#include "core/atomic_file.h"
#include "core/error.h"
#include "highlights/check_lights.h"
#include "io/mesh_io.h"
#include "io/project_images.h"
#include "io/vdb_io.h"
#include "light/light_io.h"
#include "pipeline/artifacts.h"
#include "pipeline/image_stages.h"
#include "pipeline/memory.h"
#include "pipeline/report.h"
#include "pipeline/report_page.h"
#include "pipeline/run_log.h"
#include "pipeline/seed_stage.h"
#include "pipeline/workspace.h"

namespace glint {
namespace {

// One run from project to mesh. Every stage before refinement leaves its result in the workspace and hands on what it
// reads back from there, so that a run that goes on from a later stage sees the very same values.
class Flow {
 public:
  Flow(const RunArguments& arguments, const Config& config, RunLog& log)
      : arguments_(arguments), config_(config), log_(log), out_(arguments.out) {}

  RunSummary Run() {
    Prepare();
    ReadProject();
    Stage(RunStage::kSeed, [&] { MakeSeed(); });
    const TriangleMesh seed = ReadMesh(out_.Start());
    summary_.diagonal_world = Diagonal(seed);
    const std::vector<uint8_t> point_used = ReadFlags(out_.Stages() / "points_on_object.txt", scene_.points.size());
    summary_.num_points_used = point_used.size() - std::count(point_used.begin(), point_used.end(), 0);
    CheckRefineMemory(seed, config_.refine, config_.output.memory_fraction);

    std::vector<Highlight> highlights;
    if (config_.refine.use_highlights) {
      Stage(RunStage::kDetect, [&] { Detect(); });
      highlights = ReadHighlights(out_.Stages() / "candidates.json", scene_.views.size());
      Stage(RunStage::kLights, [&] { FindLightsIfUnknown(seed, highlights); });
      TakeLights(highlights);
      Stage(RunStage::kGate, [&] { Gate(seed, highlights); });
      highlights = ReadHighlights(out_.Stages() / "highlights.json", scene_.views.size());
      RequireAccepted(highlights);
    }
    RefineResult refined;
    Stage(RunStage::kRefine, [&] {
      refined = Refine({scene_, seed, point_used, highlights, lights_}, config_.refine, log_);
    });
    Timed("write", [&] { WriteResults(refined); });
    Report("done", refined);
    return summary_;
  }

 private:
  void Prepare();
  void ReadProject();
  void MakeSeed();
  void Detect();
  void FindLightsIfUnknown(const TriangleMesh& seed, const std::vector<Highlight>& candidates);
  void TakeLights(const std::vector<Highlight>& candidates);
  void Gate(const TriangleMesh& seed, std::vector<Highlight> highlights);
  [[noreturn]] void GiveUp(const std::vector<Highlight>& highlights, const std::string& why);
  void RequireAccepted(const std::vector<Highlight>& highlights);
  void TakeRefined(const RefineResult& refined, size_t k);
  void WriteResults(const RefineResult& refined);
  void WriteHighlightPictures(const std::vector<Highlight>& highlights);
  void Report(const std::string& outcome, const RefineResult& refined);

  // Runs a stage unless the user goes on from a later one.
  template <class Work>
  void Stage(RunStage stage, const Work& work) {
    const std::string name(kRunStageNames[static_cast<size_t>(stage)]);
    if (stage < arguments_.from) {
      summary_.times.push_back({name, 0, true});
      return;
    }
    Timed(name, work);
  }

  template <class Work>
  void Timed(const std::string& name, const Work& work) {
    log_.ThrowIfCancelled();
    const auto start = std::chrono::steady_clock::now();
    work();
    log_.Finish();
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    summary_.times.push_back({name, seconds.count(), false});
  }

  void Note(const std::string& note) {
    summary_.notes.push_back(note);
    log_.Info(note);
  }

  const RunArguments& arguments_;
  const Config& config_;
  RunLog& log_;
  const Workspace out_;
  RunSummary summary_;
  Scene scene_;
  std::unique_ptr<ProjectImages> images_;
  std::vector<Light> lights_;
  std::vector<FoundLight> found_;  // the same lights first
};

void Flow::Prepare() {
  std::error_code missing;
  if (std::filesystem::equivalent(arguments_.project, out_.root(), missing))
    throw InputError(out_.root().string(), "", "is the project itself; expected another folder for the results");
  out_.RemoveResults({arguments_.lights, arguments_.mesh, arguments_.config});
  log_.WriteTo(out_.Log());
  summary_.command = arguments_.command;
  if (!arguments_.lights.empty()) lights_ = ReadLights(arguments_.lights);
  for (const Light& light : lights_) found_.emplace_back().light = light;
  summary_.lights_given = lights_;
  WriteFileAtomically(out_.Config(), ConfigYaml(config_, "The options of this run, as resolved."));
}

void Flow::ReadProject() {
  Timed("read", [&] {
    const ProjectPaths paths = FindProject(arguments_.project, arguments_.images, arguments_.masks);
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
  });
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
  if (seed.start.empty()) GiveUp({}, "no seed: the sparse points enclose no object; give a mesh with --mesh");
  WriteMesh(out_.Seed(), seed.mesh);
  WriteMesh(out_.Start(), seed.start);
  WriteFlags(out_.Stages() / "points_on_object.txt", seed.point_used);
}

void Flow::Detect() {
  WriteHighlights(out_.Stages() / "candidates.json", DetectInAllViews(scene_, *images_, config_.detect, log_));
}

void Flow::FindLightsIfUnknown(const TriangleMesh& seed, const std::vector<Highlight>& candidates) {
  for (size_t k = 0; k < lights_.size(); ++k)
    if (InsideObject(lights_[k], seed))
      throw InputError(arguments_.lights.string(), fmt::format("light {}", k), "lies inside the object");
  const std::vector<FoundLight> found =
      FindLights(scene_, *images_, seed, config_.gate, config_.lights, candidates, &summary_.find_lights, log_);
  log_.Finish();
  if (lights_.empty()) {
    WriteFoundLights(out_.Stages() / "lights.json", found);
    log_.Info(summary_.find_lights.BriefReport());
    return;
  }
  WriteLights(out_.Stages() / "lights.json", lights_);
  for (const std::string& sentence : Contradictions(lights_, found, scene_.views, BoundingBox(seed).center()))
    log_.Warn(sentence);
}

// The lights given, or those that were found.
void Flow::TakeLights(const std::vector<Highlight>& candidates) {
  if (lights_.empty()) {
    found_ = ReadFoundLights(out_.Stages() / "lights.json");
    for (const FoundLight& found : found_)
      if (found.determined) lights_.push_back(found.light);
  }
  summary_.lights = found_;
  if (!lights_.empty()) return;
  if (candidates.empty()) GiveUp(candidates, "no highlights found in any image");
  std::string why =
      fmt::format("{} candidate highlights determine no light; give the lights with --lights FILE", candidates.size());
  for (const FoundLight& found : found_) why += fmt::format("; of one, {}", found.why);
  GiveUp(candidates, why);
}

void Flow::Gate(const TriangleMesh& seed, std::vector<Highlight> highlights) {
  GateHighlights(scene_, *images_, seed, lights_, config_.gate, highlights, &summary_.gate, log_);
  WriteHighlights(out_.Stages() / "highlights.json", highlights);
  log_.Finish();
  log_.Info(summary_.gate.BriefReport());
}

void Flow::RequireAccepted(const std::vector<Highlight>& highlights) {
  const auto accepted = std::count_if(highlights.begin(), highlights.end(),
                                      [](const Highlight& h) { return h.status == HighlightStatus::kAccepted; });
  if (highlights.empty()) GiveUp(highlights, "no highlights found in any image");
  if (accepted == 0)
    GiveUp(highlights, fmt::format("none of the {} candidates is a highlight of the lights", highlights.size()));
}

// What was found so far is written, for the user to see why there is no result.
void Flow::GiveUp(const std::vector<Highlight>& highlights, const std::string& why) {
  WriteHighlightPictures(highlights);
  RefineResult nothing;
  nothing.highlights = highlights;
  Report(why, nothing);
  throw NoResultError(fmt::format("{}; what was found is in {}", why, out_.root().string()));
}

void Flow::WriteHighlightPictures(const std::vector<Highlight>& highlights) {
  for (const Highlight& h : highlights) ++summary_.highlights_by_status[static_cast<size_t>(h.status)];
  summary_.num_candidates = highlights.size();
  if (config_.output.overlays && !highlights.empty())
    WriteOverlays(scene_, *images_, highlights, config_.output.overlay_max_side_px, out_.Overlays(), log_);
  log_.Finish();
}

// What the bundle says of a light replaces what the votes did; one that was not solved for stays as it was given.
void Flow::TakeRefined(const RefineResult& refined, size_t k) {
  FoundLight& found = found_[k];
  found.light = refined.lights[k];
  if (refined.summary.iterations.empty() || refined.summary.iterations.back().bundle.lights.size() <= k) return;
  const BundleLightUpdate& update = refined.summary.iterations.back().bundle.lights[k];
  found.support = update.contacts;
  if (update.sigma <= 0) return;
  found.light.sigma = update.sigma * (found.light.type == LightType::kPoint ? summary_.diagonal_world : 1);
  found.covariance *= 0;
}

void Flow::WriteResults(const RefineResult& refined) {
  for (const std::string& warning : refined.summary.warnings) log_.Warn(warning);
  WriteHighlightPictures(refined.highlights);
  for (size_t k = 0; k < refined.lights.size(); ++k) TakeRefined(refined, k);
  WriteFoundLights(out_.Lights(), found_);
  if (!refined.level_set.empty()) WriteVdb(out_.LevelSetFile(), refined.level_set);
  WriteMesh(out_.Mesh(), refined.mesh);
  summary_.refine = refined.summary;
  summary_.lights = found_;
  summary_.num_vertices = refined.mesh.vertices.size();
  summary_.num_faces = refined.mesh.faces.size();
}

void Flow::Report(const std::string& outcome, const RefineResult& refined) {
  summary_.outcome = outcome;
  summary_.warnings = log_.Warnings();
  const TriangleMesh seed = summary_.diagonal_world > 0 ? ReadMesh(out_.Seed()) : TriangleMesh();
  WriteFileAtomically(out_.ReportPage(), ReportPage({summary_, config_, scene_, *images_, seed, refined}, log_));
  WriteFileAtomically(out_.Report(), ReportJson(summary_));
}

}  // namespace

RunSummary Run(const RunArguments& arguments, const Config& config, Progress& progress) {
  RunLog log(progress);
  try {
    return Flow(arguments, config, log).Run();
  } catch (const std::exception& e) {
    log.Failed(e.what());
    throw;
  }
}

}  // namespace glint
