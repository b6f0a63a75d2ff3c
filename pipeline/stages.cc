#include "pipeline/stages.h"

#include <fmt/format.h>

#include <chrono>

#include "core/error.h"
#include "pipeline/option_table.h"
#include "pipeline/summary_json.h"

namespace glint {
namespace {

namespace fs = std::filesystem;

std::string Name(const PlannedStage& stage) { return std::string(kRunStageNames[static_cast<size_t>(stage.stage)]); }

}  // namespace

Stages::Stages(const Workspace& out, const Config& config, RunLog& log)
    : out_(out), config_(config), log_(log), hashes_(out.Stages() / "hashes.json") {
  Give("program", fmt::format("{} {}", GLINT_VERSION, BuildId()));
}

fs::path Stages::RecordPath(const PlannedStage& stage) const { return out_.Stages() / (Name(stage) + ".record.json"); }

std::map<std::string, std::string> Stages::HashesOf(const std::vector<fs::path>& files) {
  std::map<std::string, std::string> hashes;
  for (const fs::path& file : files) hashes[file.lexically_relative(out_.root()).string()] = hashes_.Of(file);
  return hashes;
}

Ingredients Stages::IngredientsOf(const PlannedStage& stage, const RunSummary& summary) {
  Ingredients all;
  all["program"] = given_.at("program");
  for (const std::string_view name : stage.given) all[std::string(name)] = given_.at(std::string(name));
  for (const auto& [file, hash] : HashesOf(stage.reads)) all["file " + file] = hash;
  Config config = config_;
  const OptionTable table(config);
  for (const OptionItem& item : table.items())
    for (const std::string_view section : stage.options)
      if (item.kind == OptionItem::Kind::kField &&
          (section.empty() || item.path.starts_with(fmt::format("{}.", section))))
        all["option " + item.path] = FormatValue(item);
  if (stage.tells) {
    for (const RunStage told : {RunStage::kSeed, RunStage::kLights, RunStage::kGate, RunStage::kRefine})
      all[fmt::format("summary of {}", kRunStageNames[static_cast<size_t>(told)])] = SummaryPart(told, summary);
  }
  return all;
}

// Empty: it is done.
std::string Stages::WhyNotDone(const PlannedStage& stage, const std::optional<StageRecord>& record,
                               const Ingredients& now) {
  if (!record) return "it was not finished before";
  if (std::string changes = DescribeChanges(record->ingredients, now); !changes.empty()) return changes;
  for (const auto& [file, hash] : HashesOf(stage.leaves)) {
    const auto left = record->left.find(file);
    if (left == record->left.end() || left->second != hash) return fmt::format("{} is not as it was left", file);
  }
  RunSummary ignored;
  if (!TakeSummaryPart(stage.stage, record->summary, ignored)) return "its record cannot be read";
  return "";
}

bool Stages::AllDone(const std::vector<PlannedStage>& stages, RunSummary& summary) {
  RunSummary recalled = summary;
  for (const PlannedStage& stage : stages) {
    const std::optional<StageRecord> record = ReadStageRecord(RecordPath(stage));
    if (!WhyNotDone(stage, record, IngredientsOf(stage, recalled)).empty()) return false;
    TakeSummaryPart(stage.stage, record->summary, recalled);
    recalled.times.push_back({Name(stage), record->seconds, true});
  }
  summary = std::move(recalled);
  return true;
}

// The run tells of a stage that it takes over as if it had done it.
void Stages::Recall(const PlannedStage& stage, const StageRecord& record, RunSummary& summary) {
  TakeSummaryPart(stage.stage, record.summary, summary);
  for (const std::string& warning : record.warnings) log_.Warn(warning);
  summary.notes.insert(summary.notes.end(), record.notes.begin(), record.notes.end());
  summary.times.push_back({Name(stage), record.seconds, true});
  log_.EndStage(Name(stage), true, record.seconds);
}

void Stages::TakeAsItIs(const PlannedStage& stage, RunSummary& summary) {
  const fs::path& first = stage.leaves.front();
  if (hashes_.Of(first).empty())
    throw InputError(first.string(), "",
                     "missing; an earlier run leaves it, expected when starting from a later stage");
  const std::optional<StageRecord> record = ReadStageRecord(RecordPath(stage));
  const std::string why = WhyNotDone(stage, record, IngredientsOf(stage, summary));
  if (!why.empty())
    log_.Warn(fmt::format("{}: taken from the earlier run as --from asks, although {}", Name(stage), why));
  Recall(stage, record.value_or(StageRecord{}), summary);
}

void Stages::Make(const PlannedStage& stage, const Ingredients& now, RunSummary& summary) {
  const size_t notes_before = summary.notes.size(), warnings_before = log_.Warnings().size();
  const auto start = std::chrono::steady_clock::now();
  stage.make();
  log_.Finish();
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  summary.times.push_back({Name(stage), seconds.count(), false});

  StageRecord record;
  record.ingredients = now;
  record.left = HashesOf(stage.leaves);
  record.seconds = seconds.count();
  record.notes.assign(summary.notes.begin() + static_cast<std::ptrdiff_t>(notes_before), summary.notes.end());
  const std::vector<std::string> warnings = log_.Warnings();
  record.warnings.assign(warnings.begin() + static_cast<std::ptrdiff_t>(warnings_before), warnings.end());
  record.summary = SummaryPart(stage.stage, summary);
  WriteStageRecord(RecordPath(stage), record);
  hashes_.Save();
  log_.EndStage(Name(stage), false, seconds.count());
}

StagesOutcome Stages::Run(const std::vector<PlannedStage>& stages, const StageChoice& choice, RunSummary& summary) {
  if (choice.from && choice.until && *choice.until < *choice.from)
    throw InputError("", "--until", "comes before the stage of --from");
  if (!choice.from && !choice.until && AllDone(stages, summary)) return StagesOutcome::kNothingToDo;
  for (const PlannedStage& stage : stages) {
    log_.ThrowIfCancelled();
    if (choice.until && stage.stage > *choice.until) return StagesOutcome::kStopped;
    log_.BeginStage(Name(stage), static_cast<size_t>(&stage - stages.data()) + 1, stages.size());
    if (choice.from && stage.stage < *choice.from) {
      TakeAsItIs(stage, summary);
    } else {
      const Ingredients now = IngredientsOf(stage, summary);
      const std::optional<StageRecord> record = ReadStageRecord(RecordPath(stage));
      const std::string why = choice.from ? "as --from or --force asks" : WhyNotDone(stage, record, now);
      if (why.empty()) {
        Recall(stage, *record, summary);
      } else {
        if (record) log_.Info(fmt::format("{}: done anew: {}", Name(stage), why));
        Make(stage, now, summary);
      }
    }
    if (stage.take) stage.take();
  }
  return StagesOutcome::kDone;
}

}  // namespace glint
