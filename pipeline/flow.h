// The work of the stages of a run. pipeline/run.cc says in which order and from what each is done.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "colmap/project.h"
#include "colmap/scene.h"
#include "geometry/triangle_mesh.h"
#include "highlights/highlight.h"
#include "io/normal_map_files.h"
#include "io/project_images.h"
#include "light/found_light.h"
#include "pipeline/config.h"
#include "pipeline/run.h"
#include "pipeline/run_log.h"
#include "pipeline/stages.h"
#include "pipeline/workspace.h"
#include "refine/refine.h"
#include "silhouette/outline.h"

namespace glint {

// A stage leaves files in the workspace, and what later stages need is taken from these files even in the run that
// wrote them, so that a run that goes on from an earlier one sees the very same values.
class Flow {
 public:
  Flow(const RunArguments& arguments, const Config& config, RunLog& log);

  RunSummary Run();

 private:
  std::vector<PlannedStage> Plan();  // run.cc
  void Prepare();
  ProjectPaths FindOrMakeProject();
  void ReadProject();
  void LookOver(const ProjectPaths& paths);

  void MakeSeed();
  void TakeSeed();
  void Detect();
  void TakeHighlights(const std::filesystem::path& file);
  void FindLightsIfUnknown();
  void TakeLights();
  void Gate();
  void TakeGated();
  void RefineSurface();
  void TakeRefinedLights(const RefineResult& refined);
  void TakeRefined();
  void Report(const std::string& outcome);
  std::vector<std::filesystem::path> Reports() const;
  // Reports why there is no result; what was found so far is written, for the user to see.
  [[noreturn]] void GiveUp(const std::string& why);
  void Note(const std::string& note);

  const RunArguments& arguments_;
  const Config& config_;
  RunLog& log_;
  const Workspace out_;
  Stages stages_;
  RunSummary summary_;
  Scene scene_;
  std::unique_ptr<ProjectImages> images_;
  std::unique_ptr<NormalMapFiles> normals_;  // none: none are given
  TriangleMesh seed_;
  std::vector<OutlineSample> outline_;
  std::vector<uint8_t> point_used_;    // of scene_: lies on the object
  std::vector<Highlight> highlights_;  // as the last stage left them
  std::vector<Light> lights_;
  std::vector<FoundLight> found_;  // the same lights first
  RefineResult refined_;           // without its level set
};

}  // namespace glint
