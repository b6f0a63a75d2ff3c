// The bookkeeping of a run: which stages have been done already and need not be done again.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/config.h"
#include "pipeline/file_hashes.h"
#include "pipeline/run.h"
#include "pipeline/run_log.h"
#include "pipeline/stage_record.h"
#include "pipeline/workspace.h"

namespace glint {

// One stage: what decides its result, what it leaves in the workspace, and how.
struct PlannedStage {
  RunStage stage = RunStage::kSeed;
  std::vector<std::string_view> given = {};        // of what comes from outside, see Stages::Give()
  std::vector<std::filesystem::path> reads = {};   // what stages before it left
  std::vector<std::string_view> options = {};      // sections of the configuration; "": all of it
  std::vector<std::filesystem::path> leaves = {};  // a stage may leave less than this, but always the first
  std::function<void()> make = {};                 // does the stage and leaves its files
  std::function<void()> take = {};                 // reads from them what later stages need
  bool tells = false;                              // the summary of the stages before it goes into its result
};

enum class StagesOutcome { kDone, kNothingToDo, kStopped };

class Stages {
 public:
  Stages(const Workspace& out, const Config& config, RunLog& log);

  FileHashes& hashes() { return hashes_; }
  // Something from outside that decides results: its name for people and its hash.
  void Give(const std::string& name, const std::string& hash) { given_[name] = hash; }

  // Does the stages in their order, each unless it was done before from the same program, inputs and options and what
  // it left is still there; its part of `summary` is filled either way. What was done is remembered in the workspace as
  // soon as it is done. Stages before `choice.from` are taken as they are; those from there on are always done.
  StagesOutcome Run(const std::vector<PlannedStage>& stages, const StageChoice& choice, RunSummary& summary);

 private:
  Ingredients IngredientsOf(const PlannedStage& stage, const RunSummary& summary);
  std::map<std::string, std::string> HashesOf(const std::vector<std::filesystem::path>& files);
  std::filesystem::path RecordPath(const PlannedStage& stage) const;
  std::string WhyNotDone(const PlannedStage& stage, const std::optional<StageRecord>& record, const Ingredients& now);
  bool AllDone(const std::vector<PlannedStage>& stages, RunSummary& summary);
  void Recall(const PlannedStage& stage, const StageRecord& record, RunSummary& summary);
  void TakeAsItIs(const PlannedStage& stage, RunSummary& summary);
  void Make(const PlannedStage& stage, const Ingredients& now, RunSummary& summary);

  const Workspace& out_;
  const Config& config_;
  RunLog& log_;
  FileHashes hashes_;
  Ingredients given_;
};

}  // namespace glint
