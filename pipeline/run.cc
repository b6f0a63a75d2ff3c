#include "pipeline/run.h"

#include <fmt/format.h>

#include "pipeline/flow.h"

namespace glint {

// The whole way from a project to a mesh: what decides each stage's result, what it leaves in the workspace, what is
// done for it, and what the stages after it take.
std::vector<PlannedStage> Flow::Plan() {
  const PlannedStage seed = {
      .stage = RunStage::kSeed,
      .given = {"model", "images", "mesh"},
      .options = {arguments_.mesh.empty() ? "seed" : "given_mesh"},
      .leaves = {out_.Start(), out_.Seed(), out_.PointsOnObject(), out_.Points(), out_.Outline()},
      .make = [this] { MakeSeed(); },
      .take = [this] { TakeSeed(); }};
  const PlannedStage detect = {.stage = RunStage::kDetect,
                               .given = {"model", "images"},
                               .options = {"detect"},
                               .leaves = {out_.Candidates()},
                               .make = [this] { Detect(); },
                               .take = [this] { TakeHighlights(out_.Candidates()); }};
  const PlannedStage lights = {.stage = RunStage::kLights,
                               .given = {"model", "images", "lights"},
                               .reads = {out_.Start(), out_.Candidates()},
                               .options = {"gate", "lights"},
                               .leaves = {out_.StageLights()},
                               .make = [this] { FindLightsIfUnknown(); },
                               .take = [this] { TakeLights(); }};
  const PlannedStage gate = {.stage = RunStage::kGate,
                             .given = {"model", "images"},
                             .reads = {out_.Start(), out_.Candidates(), out_.StageLights()},
                             .options = {"gate"},
                             .leaves = {out_.Gated()},
                             .make = [this] { Gate(); },
                             .take = [this] { TakeGated(); }};
  PlannedStage refine = {.stage = RunStage::kRefine,
                         .given = {"model", "images", "lights", "normals"},
                         .reads = {out_.Start(), out_.PointsOnObject(), out_.Outline()},
                         .options = {"normals", "refine"},
                         .leaves = {out_.Mesh(), out_.LevelSetFile(), out_.Lights(), out_.Refined(), out_.Contacts()},
                         .make = [this] { RefineSurface(); },
                         .take = [this] { TakeRefined(); }};
  const PlannedStage report = {.stage = RunStage::kReport,
                               .given = {"model", "images", "lights", "mesh"},
                               .reads = {out_.Seed(), out_.Mesh(), out_.Lights(), out_.Refined(), out_.Contacts()},
                               .options = {""},
                               .leaves = Reports(),
                               .make = [this] { Report("done"); },
                               .tells = true};
  if (!config_.refine.use_highlights) return {seed, refine, report};
  refine.reads.insert(refine.reads.end(), {out_.StageLights(), out_.Gated()});
  return {seed, detect, lights, gate, refine, report};
}

RunSummary Flow::Run() {
  Prepare();
  ReadProject();
  switch (stages_.Run(Plan(), arguments_.stages, summary_)) {
    case StagesOutcome::kDone:
      break;
    case StagesOutcome::kStopped:
      summary_.outcome = fmt::format("stopped after {}", kRunStageNames[static_cast<size_t>(*arguments_.stages.until)]);
      break;
    case StagesOutcome::kNothingToDo:
      summary_.outcome = "nothing to do";
      break;
  }
  return summary_;
}

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
