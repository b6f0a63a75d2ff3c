// Photographs to a model: which images are matched, and how the program is run, with a script in its place.
#include "colmap/reconstruct.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "colmap/matching_plan.h"
#include "colmap/project.h"
#include "core/error.h"
#include "tests/colmap/fake_colmap.h"
#include "tests/colmap/test_model.h"

namespace glint {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing_support::FakeColmap;
using testing_support::ReadText;
using testing_support::Runs;
using testing_support::SmallModel;
using testing_support::TemporaryFolder;
using testing_support::WriteFile;

std::vector<std::string> Numbered(int count) {
  std::vector<std::string> names;
  for (int i = 0; i < count; ++i) names.push_back("img_" + std::to_string(i) + ".jpg");
  return names;
}

TEST(Photographs, AreFoundInTheOrderOfTheirNumbers) {
  const TemporaryFolder folder;
  for (const char* name :
       {"img10.JPG", "img9.jpg", "sub/übung 1.png", ".hidden.jpg", ".cache/a.jpg", "masks/img9.jpg.png", "notes.txt",
        "a.heic", "out/highlights/b.png", "earlier/log.txt", "earlier/stages/a.json", "earlier/highlights/c.png"})
    WriteFile(folder / name, "x");
  const Photographs found = FindPhotographs(folder.path(), folder / "out");
  EXPECT_THAT(found.names, ElementsAre("img9.jpg", "img10.JPG", "sub/übung 1.png"));
  EXPECT_EQ(found.masks, folder / "masks");
  EXPECT_THAT(found.unreadable_kinds, ElementsAre(".heic"));
}

TEST(Photographs, MayLieInASubfolderOfTheUsualName) {
  const TemporaryFolder folder;
  for (const char* name : {"images/1.png", "other/2.png"}) WriteFile(folder / name, "x");
  const Photographs found = FindPhotographs(folder.path());
  EXPECT_EQ(found.folder, folder / "images");
  EXPECT_THAT(found.names, ElementsAre("1.png"));
}

TEST(Photographs, SequenceIsTold) {
  EXPECT_TRUE(InSequence(Numbered(20)));
  EXPECT_FALSE(InSequence({"roof.jpg", "door.jpg", "wall.jpg"}));
  EXPECT_FALSE(InSequence({"a100.jpg", "a2500.jpg", "a99000.jpg"}));
}

TEST(MatchingPlan, FollowsNumberAndOrder) {
  Photographs photographs;
  photographs.names = Numbered(60);
  EXPECT_EQ(PlanMatching(photographs, "auto", false, 3000).kind, MatchingKind::kExhaustive);
  photographs.names = Numbered(600);
  EXPECT_EQ(PlanMatching(photographs, "auto", false, 3000).kind, MatchingKind::kExhaustive) << "in no order";
  EXPECT_EQ(PlanMatching(photographs, "auto", true, 3000).kind, MatchingKind::kVocabulary);
  photographs.in_sequence = true;
  EXPECT_EQ(PlanMatching(photographs, "auto", true, 3000).kind, MatchingKind::kSequence);
  photographs.names[5] = "with a blank.jpg";
  EXPECT_EQ(PlanMatching(photographs, "auto", false, 3000).kind, MatchingKind::kExhaustive)
      << "COLMAP cannot read pairs";
}

TEST(MatchingPlan, SequenceClosesItsLoops) {
  const auto names = Numbered(200);
  const auto pairs = SequencePairs(names, 4000);
  EXPECT_THAT(pairs, Contains(std::pair(names[7], names[8])));
  EXPECT_THAT(pairs, Contains(std::pair(names[0], names[10])));
  const auto near = [](const std::string& name) { return std::stoi(name.substr(4)); };
  size_t ends = 0;
  for (const auto& [a, b] : pairs) {
    EXPECT_LT(near(a), near(b));
    ends += near(a) < 20 && near(b) >= 180;
  }
  EXPECT_GT(ends, 5u);
  EXPECT_LE(pairs.size(), 4400u);
}

class ReconstructTest : public testing::Test {
 protected:
  ReconstructTest() : colmap_(folder_ / "bin") {
    photographs_.folder = folder_ / "photographs";
    photographs_.names = {"1.jpg", "2.jpg", "3.jpg", "4.jpg"};
    for (const std::string& name : photographs_.names) WriteFile(photographs_.folder / name, name);
    WriteModel(SmallModel(), colmap_.Model() / "0");
    options_.program = colmap_.Program();
  }

  ReconstructSummary Run(Progress& progress = Progress::Silent()) const {
    return Reconstruct(photographs_, folder_ / "out", options_, progress);
  }
  std::string Failure() const {
    try {
      Run();
    } catch (const InputError& e) {
      return e.what();
    }
    return "no failure";
  }

  TemporaryFolder folder_;
  FakeColmap colmap_;
  Photographs photographs_;
  ReconstructOptions options_;
};

class Recorder : public Progress {
 public:
  void Begin(std::string_view what, size_t total) override { units.push_back({std::string(what), 0, total}); }
  void Advance(size_t steps) override { units.back().done += steps; }
  struct Unit {
    std::string what;
    size_t done, total;
  };
  std::vector<Unit> units;
};

TEST_F(ReconstructTest, RunsEveryStepOnce) {
  Recorder progress;
  const ReconstructSummary summary = Run(progress);
  EXPECT_THAT(colmap_.Calls(), ElementsAre("feature_extractor", "exhaustive_matcher", "mapper"));
  EXPECT_EQ(summary.version, "3.8");
  EXPECT_EQ(summary.num_registered(), 4u);
  EXPECT_EQ(FindProject(folder_ / "out", photographs_.folder).model, folder_ / "out/sparse/0");
  EXPECT_THAT(colmap_.Lines(), AllOf(HasSubstr("--SiftExtraction.use_gpu 0"), HasSubstr("--SiftMatching.use_gpu 0")));
  EXPECT_THAT(ReadText(folder_ / "out/log.txt"),
              AllOf(HasSubstr("$ colmap mapper"), HasSubstr("Processed file [4/4]")));
  ASSERT_EQ(progress.units.size(), 3u);
  EXPECT_EQ(progress.units[0].total, 4u);
  EXPECT_EQ(progress.units[0].done, 4u);

  const ReconstructSummary again = Run();
  EXPECT_THAT(colmap_.Calls(), IsEmpty());
  EXPECT_EQ(again.num_registered(), 4u);
  EXPECT_TRUE(again.steps[1].reused);
}

TEST_F(ReconstructTest, GoesOnWhereItWasStopped) {
  colmap_.Write("exhaustive_matcher", "exit 1");
  EXPECT_THAT(Failure(), AllOf(HasSubstr("exhaustive_matcher"), HasSubstr("exit code 1")));
  colmap_.Write("", "");
  colmap_.Calls();
  EXPECT_EQ(Run().num_registered(), 4u);
  EXPECT_THAT(colmap_.Calls(), ElementsAre("exhaustive_matcher", "mapper"));
}

TEST_F(ReconstructTest, ChangedPhotographsAreNotTakenForDone) {
  Run();
  colmap_.Calls();
  WriteFile(folder_ / "out/database.db", "old");
  WriteFile(photographs_.folder / "2.jpg", "another picture");
  Run();
  EXPECT_THAT(colmap_.Calls(), ElementsAre("feature_extractor", "exhaustive_matcher", "mapper"));
  EXPECT_FALSE(fs::exists(folder_ / "out/database.db")) << "COLMAP would keep the features of the old picture";
}

TEST_F(ReconstructTest, ProgramThatIsMissingIsNamedWithHowToInstallIt) {
  options_.program = "colmap-that-is-not-there";
  EXPECT_THAT(Failure(), AllOf(HasSubstr("colmap-that-is-not-there"), HasSubstr("apt-get install colmap")));
}

TEST_F(ReconstructTest, FailureSaysWhatColmapSaidLast) {
  colmap_.Write("feature_extractor", "echo 'ERROR: disk is full' >&2; exit 7");
  EXPECT_THAT(Failure(), AllOf(HasSubstr("log.txt"), HasSubstr("feature_extractor"), HasSubstr("exit code 7"),
                               HasSubstr("disk is full")));
  colmap_.Write("mapper", "kill -SEGV $$");
  EXPECT_THAT(Failure(), AllOf(HasSubstr("mapper"), HasSubstr("signal 11")));
  EXPECT_FALSE(fs::exists(folder_ / "out/sparse"));
}

TEST_F(ReconstructTest, HangIsEnded) {
  options_.stall_limit_min = 0.3 / 60;
  const fs::path pid = folder_ / "pid";
  colmap_.Write("exhaustive_matcher", "sleep 60 & echo $! > " + pid.string() + "; wait");
  EXPECT_THAT(Failure(), AllOf(HasSubstr("hung"), HasSubstr("stall_limit_min")));
  EXPECT_FALSE(Runs(pid));
}

TEST_F(ReconstructTest, BusyProgramIsNotTakenForHangingButHasATimeLimit) {
  options_.stall_limit_min = 0.8 / 60;  // another program may have the processor for as long as half a second
  options_.time_limit_min = 1.2 / 60;
  colmap_.Write("exhaustive_matcher", "while true; do :; done");
  EXPECT_THAT(Failure(), AllOf(Not(HasSubstr("hung")), HasSubstr("time_limit_min")));
}

class StopsOnce : public Progress {
 public:
  explicit StopsOnce(fs::path file) : file_(std::move(file)) {}
  bool Cancelled() const override { return fs::exists(file_) && fs::file_size(file_) > 0; }

 private:
  fs::path file_;
};

TEST_F(ReconstructTest, CtrlCEndsTheProgramAndAllItStarted) {
  const fs::path pid = folder_ / "pid";
  colmap_.Write("mapper", "sleep 60 & echo $! > " + pid.string() + "; wait");
  StopsOnce progress(pid);
  EXPECT_THROW(Run(progress), CancelledError);
  EXPECT_FALSE(Runs(pid));
  fs::remove(pid);
  colmap_.Write("", "");
  colmap_.Calls();
  EXPECT_EQ(Run().num_registered(), 4u);
  EXPECT_THAT(colmap_.Calls(), ElementsAre("mapper"));
}

TEST_F(ReconstructTest, NoModelIsAValueWithAdvice) {
  colmap_.Write("mapper", "echo 'ERROR: failed to create sparse model'; exit 1");
  const ReconstructSummary summary = Run();
  EXPECT_EQ(summary.num_registered(), 0u);
  EXPECT_EQ(summary.median_features, 90u);
  EXPECT_THAT(summary.Advice(), Contains(HasSubstr("90 features")));
}

TEST_F(ReconstructTest, LargestSubModelCounts) {
  WriteModel(SmallModel(2), colmap_.Model() / "1");
  const ReconstructSummary summary = Run();
  EXPECT_THAT(summary.model_sizes, ElementsAre(4u, 2u));
  EXPECT_THAT(summary.Advice(), Contains(HasSubstr("2 groups")));
  EXPECT_THAT(FindProject(folder_ / "out", photographs_.folder).notes, Contains(HasSubstr("took 0")));
}

TEST_F(ReconstructTest, SequenceIsMatchedByPairs) {
  options_.matcher = "sequence";
  EXPECT_EQ(Run().matcher, "sequence");
  EXPECT_THAT(colmap_.Calls(), ElementsAre("feature_extractor", "matches_importer", "mapper"));
  EXPECT_THAT(ReadText(folder_ / "out/pairs.txt"), HasSubstr("1.jpg 4.jpg\n"));
}

}  // namespace
}  // namespace glint
