// The main job: a COLMAP project in, a better mesh out.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/progress.h"
#include "highlights/find_lights.h"
#include "highlights/gate.h"
#include "light/light.h"
#include "pipeline/config.h"
#include "refine/refine.h"

namespace glint {

// The stages whose results are kept in the workspace, in their order; a run can go on from any of them. "photos" makes
// the COLMAP project and has nothing to do where one is given.
enum class RunStage { kPhotos, kSeed, kDetect, kLights, kGate, kRefine, kReport };
inline constexpr std::array<std::string_view, 7> kRunStageNames = {"photos", "seed",   "detect", "lights",
                                                                   "gate",   "refine", "report"};

// Which stages are done. Unless told otherwise, those whose results are not in the workspace yet.
struct StageChoice {
  std::optional<RunStage> from;   // those before it are taken as they are, this and later ones are done in any case
  std::optional<RunStage> until;  // the last one
};

struct RunArguments {
  std::filesystem::path project;
  std::filesystem::path out;
  std::filesystem::path images;   // empty: found in the project
  std::filesystem::path masks;    // empty: found in the project, or none
  std::filesystem::path lights;   // empty: unknown
  std::filesystem::path config;   // where the configuration came from, if from a file
  std::filesystem::path mesh;     // empty: the seed is made from the sparse points
  std::filesystem::path normals;  // empty: no normal maps
  StageChoice stages;
  std::string command;  // as typed, for the report
};

struct StageTime {
  std::string stage;
  double seconds = 0;
  bool reused = false;  // taken from an earlier run, which spent the seconds
};

// Everything that is to be said of a run, as data; report.json is made from it.
struct RunSummary {
  std::string command;
  std::string outcome;  // "done", "nothing to do", "stopped after STAGE", or why there is no result
  std::filesystem::path model;
  std::filesystem::path images;
  std::string colmap_version;  // empty: COLMAP was not needed
  size_t num_views = 0;
  size_t num_missing_images = 0;
  size_t num_points = 0;
  size_t num_points_used = 0;
  std::vector<std::string> notes;  // choices that were made
  std::vector<std::string> warnings;
  std::string seed_report;
  size_t num_candidates = 0;
  FindLightsSummary find_lights;  // where none are given
  GateSummary gate;
  RefineSummary refine;
  std::vector<Light> lights_given;
  std::vector<FoundLight> lights;  // that count, then those that are not determined
  std::array<size_t, kNumHighlightStatuses> highlights_by_status{};
  double diagonal_world = 0;  // of the seed
  size_t num_vertices = 0, num_faces = 0;
  std::vector<StageTime> times;
};

// Runs the stages that are not done yet (pipeline/stages.h) and writes the workspace (pipeline/workspace.h). The
// results of an earlier run stay until they are replaced. Throws InputError, NoResultError (after writing what there
// is, and the report) or CancelledError. What the run says goes to `progress` and to the log file.
RunSummary Run(const RunArguments& arguments, const Config& config, Progress& progress = Progress::Silent());

}  // namespace glint
