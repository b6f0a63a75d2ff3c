#include "colmap/reconstruct.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <fstream>
#include <functional>

#include "colmap/colmap_program.h"
#include "colmap/matching_plan.h"
#include "colmap/project.h"
#include "colmap/step_record.h"
#include "core/atomic_file.h"
#include "core/error.h"
#include "core/median.h"
#include "core/parallel.h"

namespace glint {
namespace {

namespace fs = std::filesystem;
using Arguments = std::vector<std::string>;

constexpr size_t kGpuFactor = 20;  // times as many pairs in the same time
constexpr size_t kPairsACall = 100;

Arguments operator+(Arguments a, const Arguments& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

std::string Lines(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += name + "\n";
  return text;
}

class Reconstruction {
 public:
  Reconstruction(const Photographs& photographs, const fs::path& folder, const ReconstructOptions& options,
                 Progress& progress)
      : photographs_(photographs),
        folder_(folder),
        options_(options),
        progress_(progress),
        colmap_(options.program, progress),
        gpu_(options.use_gpu && colmap_.has_cuda()) {
    fs::create_directories(folder_);
  }

  ReconstructSummary Run() {
    summary_.version = colmap_.version();
    summary_.gpu = gpu_;
    summary_.num_images = photographs_.names.size();
    Features();
    Matches();
    Mapper();
    summary_.model_sizes = SubModelSizes(folder_ / "sparse");
    std::sort(summary_.model_sizes.rbegin(), summary_.model_sizes.rend());
    return summary_;
  }

 private:
  void Features();
  void Matches();
  void MatchSequence(const MatchingPlan& plan, const Arguments& machine);
  void Mapper();
  ChildResult Call(const std::string& command, const Arguments& arguments,
                   const std::function<void(std::string_view)>& on_line);
  void Require(const ChildResult& result, const std::string& command) const;

  std::string Database() const { return (folder_ / "database.db").string(); }

  // Does `work` unless an earlier run has finished it with the same inputs; these add to those of the steps before.
  void Step(const std::string& name, const std::string& inputs, const std::function<void(const StepRecord&)>& work) {
    inputs_ += inputs + "\n";
    const StepRecord record(folder_, name, inputs_);
    const bool done = record.Done();
    const auto start = std::chrono::steady_clock::now();
    if (!done) {
      work(record);
      record.MarkDone();
    }
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    summary_.steps.push_back({name, done ? 0 : seconds.count(), done});
  }

  // On which processor, with how many threads; COLMAP 4 has other names for the groups.
  Arguments Machine(const std::string& command, const std::string& group, const std::string& new_group) const {
    const auto option = [&](const std::string& name, int value) {
      return colmap_.Option(command, {group + name, new_group + name}, std::to_string(value), progress_);
    };
    return option(".use_gpu", gpu_ ? 1 : 0) + option(".num_threads", NumThreads());
  }

  // Advances to what is done so far.
  void AdvanceTo(size_t done) {
    if (done > advanced_) progress_.Advance(done - advanced_);
    advanced_ = std::max(advanced_, done);
  }
  void Begin(const std::string& what, size_t total) {
    progress_.Begin(what, total);
    advanced_ = 0;
  }

  const Photographs& photographs_;
  const fs::path folder_;
  const ReconstructOptions& options_;
  Progress& progress_;
  const ColmapProgram colmap_;
  const bool gpu_;
  std::string inputs_;
  size_t advanced_ = 0;
  ReconstructSummary summary_;
};

ChildResult Reconstruction::Call(const std::string& command, const Arguments& arguments,
                                 const std::function<void(std::string_view)>& on_line) {
  ChildOptions child;
  child.log = folder_ / "log.txt";
  child.stall_limit_s = 60 * options_.stall_limit_min;
  child.time_limit_s = 60 * options_.time_limit_min;
  std::ofstream log(child.log, std::ios::app);
  log << "\n$ colmap " << command;
  for (const std::string& argument : arguments) log << " '" << argument << "'";
  log << "\n" << std::flush;
  return colmap_.Run(command, arguments, child, on_line, progress_);
}

void Reconstruction::Require(const ChildResult& result, const std::string& command) const {
  if (result.ok()) return;
  std::string why;
  switch (result.end) {
    case ChildEnd::kExited:
      why = fmt::format("ended with exit code {}", result.code);
      break;
    case ChildEnd::kSignal:
      why = fmt::format("was ended by signal {} ({})", result.code, strsignal(result.code));
      break;
    case ChildEnd::kStalled:
      why = fmt::format(
          "hung and was ended: for {} minutes it printed nothing and used no processor time "
          "(photos.colmap.stall_limit_min)",
          options_.stall_limit_min);
      break;
    case ChildEnd::kTooLong:
      why = fmt::format("was ended after {} minutes (photos.colmap.time_limit_min)", options_.time_limit_min);
  }
  throw InputError((folder_ / "log.txt").string(), "colmap " + command,
                   why + "; what is finished is kept" + (result.tail.empty() ? "" : ". It said last\n" + result.tail));
}

void Reconstruction::Features() {
  Arguments arguments = {"--ImageReader.camera_model", options_.camera_model, "--ImageReader.single_camera",
                         photographs_.one_camera ? "1" : "0"};
  if (!photographs_.feature_masks.empty())
    arguments = arguments + Arguments{"--ImageReader.mask_path", photographs_.feature_masks};
  const std::string side = std::to_string(options_.max_side_px);
  std::string inputs = colmap_.version() + "\n" + Lines(arguments) + side + "\n" + photographs_.folder.string() + "\n";
  for (const std::string& name : photographs_.names) {
    inputs += FileStamp(photographs_.folder / name);
    if (!photographs_.feature_masks.empty()) inputs += FileStamp(photographs_.feature_masks / (name + ".png"));
  }
  Step("features", inputs, [&](const StepRecord& record) {
    if (!record.Begun())  // else COLMAP skips the images that it has done
      for (const char* suffix : {"", "-wal", "-shm", "-journal"}) fs::remove(Database() + suffix);
    record.MarkBegun();
    WriteFileAtomically(folder_ / "photographs.txt", Lines(photographs_.names));
    const std::string command = "feature_extractor";
    arguments = arguments + Arguments{"--database_path",   Database(),          "--image_path",
                                      photographs_.folder, "--image_list_path", folder_ / "photographs.txt"} +
                colmap_.Option(command, {"SiftExtraction.max_image_size", "FeatureExtraction.max_image_size"}, side,
                               progress_) +
                Machine(command, "SiftExtraction", "FeatureExtraction");
    Begin("COLMAP: features", photographs_.names.size());
    std::vector<double> counts;
    Require(Call(command, arguments,
                 [&](std::string_view line) {
                   AdvanceTo(CountAfter(line, "Processed file ["));
                   if (const size_t count = CountAfter(line, "  Features:"))
                     counts.push_back(static_cast<double>(count));
                 }),
            command);
    summary_.median_features = static_cast<size_t>(Median(counts));
  });
}

void Reconstruction::Matches() {
  const size_t n = photographs_.names.size();
  const size_t max_pairs = static_cast<size_t>(options_.max_pairs) * (gpu_ ? kGpuFactor : 1);
  const MatchingPlan plan = PlanMatching(photographs_, options_.matcher, !options_.vocabulary_tree.empty(), max_pairs);
  summary_.matcher = MatchingName(plan.kind);
  const std::string inputs = summary_.matcher + " " + std::to_string(plan.pairs.size()) + options_.vocabulary_tree;
  Step("matches", inputs, [&](const StepRecord& record) {
    record.MarkBegun();  // COLMAP skips the pairs that it has matched, for whichever reason it had
    const bool exhaustive = plan.kind == MatchingKind::kExhaustive;
    const std::string command = exhaustive                               ? "exhaustive_matcher"
                                : plan.kind == MatchingKind::kVocabulary ? "vocab_tree_matcher"
                                                                         : "matches_importer";
    const Arguments machine = Machine(command, "SiftMatching", "FeatureMatching");
    if (plan.kind == MatchingKind::kSequence) return MatchSequence(plan, machine);
    Arguments arguments = Arguments{"--database_path", Database()} + machine;
    size_t total = n;
    const size_t block = std::max<size_t>(8, n / 25), blocks = (n + block - 1) / block;
    if (exhaustive) {
      arguments = arguments + Arguments{"--ExhaustiveMatching.block_size", std::to_string(block)};
      total = blocks * blocks;
    } else {
      arguments = arguments + Arguments{"--VocabTreeMatching.vocab_tree_path", options_.vocabulary_tree};
    }
    Begin("COLMAP: matches", total);
    // "Matching block [2/6, 5/6]" is said of what begins, "Matching image [7/48]" too; COLMAP 4 calls it "Processing".
    Require(Call(command, arguments,
                 [&](std::string_view line) {
                   if (line.find("ing block [") == line.npos && line.find("ing image [") == line.npos) return;
                   const size_t row = CountAfter(line, "["), column = CountAfter(line, ", ");
                   if (row > 0) AdvanceTo(exhaustive && column > 0 ? (row - 1) * blocks + column - 1 : row - 1);
                 }),
            command);
    AdvanceTo(total);
  });
}

// In small parts, for progress and so that little is lost when it is stopped.
void Reconstruction::MatchSequence(const MatchingPlan& plan, const Arguments& machine) {
  Begin("COLMAP: matches", plan.pairs.size());
  for (size_t first = 0; first < plan.pairs.size(); first += kPairsACall) {
    const size_t end = std::min(first + kPairsACall, plan.pairs.size());
    std::string list;
    for (size_t i = first; i < end; ++i) list += plan.pairs[i].first + " " + plan.pairs[i].second + "\n";
    WriteFileAtomically(folder_ / "pairs.txt", list);
    const Arguments arguments = {"--database_path",     Database(),     "--match_list_path",
                                 folder_ / "pairs.txt", "--match_type", "pairs"};
    Require(Call("matches_importer", arguments + machine, [](std::string_view) {}), "matches_importer");
    AdvanceTo(end);
  }
}

void Reconstruction::Mapper() {
  Step("mapper", "", [&](const StepRecord& record) {
    const size_t n = photographs_.names.size();
    const fs::path unfinished = folder_ / "sparse.unfinished";
    record.MarkBegun();
    for (const fs::path& old : {unfinished, folder_ / "sparse"}) fs::remove_all(old);
    fs::create_directories(unfinished);
    const Arguments arguments = {"--database_path",
                                 Database(),
                                 "--image_path",
                                 photographs_.folder,
                                 "--output_path",
                                 unfinished,
                                 "--Mapper.min_model_size",
                                 std::to_string(std::clamp<size_t>(n / 4, 3, 10)),
                                 "--Mapper.num_threads",
                                 std::to_string(NumThreads())};
    Begin("COLMAP: mapper", n);
    bool no_model = false;
    const ChildResult result = Call("mapper", arguments, [&](std::string_view line) {
      // "Registering image #4 (3)"; COLMAP 4: "Registering image #4 (num_reg_frames=3)".
      const size_t registering = line.find("Registering image #");
      if (registering != line.npos) AdvanceTo(std::min(n, CountAfter(line.substr(registering), "(")));
      no_model = no_model || line.find("failed to create sparse model") != line.npos;
    });
    if (!no_model) Require(result, "mapper");
    fs::rename(unfinished, folder_ / "sparse");
  });
}

}  // namespace

ReconstructSummary Reconstruct(const Photographs& photographs, const fs::path& folder,
                               const ReconstructOptions& options, Progress& progress) {
  return Reconstruction(photographs, folder, options, progress).Run();
}

}  // namespace glint
