#include "pipeline/stage_record.h"

#include <gmock/gmock.h>

#include <fstream>
#include <limits>

#include "core/error.h"
#include "pipeline/summary_json.h"
#include "tests/pipeline/program.h"

namespace glint {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class StageRecordTest : public ProgramTest {};

TEST_F(StageRecordTest, ReadsBackWhatWasWritten) {
  StageRecord record;
  record.ingredients = {{"images", "ab"}, {"option seed.x", "1.5"}};
  record.left = {{"seed.ply", "cd"}, {"sdf.vdb", ""}};
  record.seconds = 1.25;
  record.warnings = {"careful \"there\""};
  record.notes = {"n"};
  record.summary = "{}";
  WriteStageRecord(folder_ / "seed.json", record);
  const auto read = ReadStageRecord(folder_ / "seed.json");
  ASSERT_TRUE(read);
  EXPECT_EQ(read->ingredients, record.ingredients);
  EXPECT_EQ(read->left, record.left);
  EXPECT_EQ(read->seconds, 1.25);
  EXPECT_EQ(read->warnings, record.warnings);
  EXPECT_EQ(read->notes, record.notes);
  EXPECT_EQ(read->summary, "{}");
}

TEST_F(StageRecordTest, AnUnsoundRecordIsNone) {
  EXPECT_FALSE(ReadStageRecord(folder_ / "none.json"));
  for (const char* text : {"", "{", "[]", "{\"ingredients\": 1}", "{\"ingredients\": {}, \"left\": {\"a\": 1}}"}) {
    Write("seed.json", text);
    EXPECT_FALSE(ReadStageRecord(folder_ / "seed.json")) << text;
  }
}

TEST(DescribeChanges, NamesWhatDiffers) {
  EXPECT_EQ(DescribeChanges({{"images", "a"}}, {{"images", "a"}}), "");
  EXPECT_EQ(DescribeChanges({{"option refine.levels", "2"}}, {{"option refine.levels", "3"}}),
            "refine.levels was 2, is 3");
  EXPECT_THAT(DescribeChanges({{"file stages/start.ply", "a"}, {"program", "1"}},
                              {{"file stages/start.ply", "b"}, {"program", "2"}}),
              AllOf(HasSubstr("stages/start.ply"), HasSubstr("another build")));
  EXPECT_THAT(DescribeChanges({}, {{"a", ""}, {"b", ""}, {"c", ""}, {"d", ""}, {"e", ""}}),
              AllOf(HasSubstr("2 more"), Not(HasSubstr("d"))));
}

RunSummary FilledSummary() {
  RunSummary summary;
  summary.seed_report = "a seed";
  summary.find_lights.candidates = 7;
  summary.find_lights.lights.emplace_back().covariance(1, 2) = 1.0 / 3;
  summary.gate.by_status[2] = 5;
  summary.gate.median_normal_error_deg = {0.1, std::numeric_limits<double>::infinity()};
  summary.refine.iterations.emplace_back().bundle.lights.emplace_back().sigma = 0.7;
  summary.refine.iterations[0].bundle.message = "inf";
  summary.refine.warnings = {"not converged"};
  summary.lights.emplace_back().why = "too few";
  summary.num_faces = 12;
  return summary;
}

TEST(SummaryPart, EveryStageReadsBackExactly) {
  const RunSummary filled = FilledSummary();
  RunSummary taken;
  for (size_t s = 0; s < kRunStageNames.size(); ++s) {
    const auto stage = static_cast<RunStage>(s);
    ASSERT_TRUE(TakeSummaryPart(stage, SummaryPart(stage, filled), taken)) << kRunStageNames[s];
    EXPECT_EQ(SummaryPart(stage, taken), SummaryPart(stage, filled)) << kRunStageNames[s];
  }
  EXPECT_EQ(taken.seed_report, "a seed");
  EXPECT_EQ(taken.find_lights.lights.at(0).covariance(1, 2), 1.0 / 3);
  EXPECT_EQ(taken.gate.by_status[2], 5u);
  EXPECT_EQ(taken.gate.median_normal_error_deg.at(1), std::numeric_limits<double>::infinity());
  EXPECT_EQ(taken.refine.iterations.at(0).bundle.lights.at(0).sigma, 0.7);
  EXPECT_EQ(taken.refine.iterations.at(0).bundle.message, "inf");
  EXPECT_EQ(taken.lights.at(0).why, "too few");
  EXPECT_EQ(taken.num_faces, 12u);
}

TEST(SummaryPart, UnsoundTextChangesNothing) {
  for (const char* text : {"", "{}", "{\"gate\": 1}", "{\"gate\": {\"candidates\": \"x\"}}"}) {
    RunSummary summary = FilledSummary();
    EXPECT_FALSE(TakeSummaryPart(RunStage::kGate, text, summary)) << text;
    EXPECT_EQ(summary.gate.by_status[2], 5u);
  }
}

class ContactsFile : public ProgramTest {};

TEST_F(ContactsFile, ReadsBackExactlyWithThePosesOfTheViews) {
  Scene scene;
  scene.views.resize(3);
  scene.views[2].cam_from_world.translation = {1, 2, 3};
  Contact contact;
  contact.view = 2;
  contact.highlight = 4;
  contact.origin = {0.1, 0.2, 0.3};
  contact.direction = Eigen::Vector3d(1, 2, 3).normalized();
  contact.depth = std::numeric_limits<double>::quiet_NaN();
  contact.axis_rays.fill(Eigen::Vector3d::UnitY());
  contact.reason = HighlightStatus::kGrazing;
  WriteContacts(folder_ / "contacts.json", {contact, contact});
  const std::vector<Contact> read = ReadContacts(folder_ / "contacts.json", scene, 10, 10);
  ASSERT_EQ(read.size(), 2u);
  EXPECT_EQ(read[1].direction, contact.direction);
  EXPECT_TRUE(std::isnan(read[1].depth));
  EXPECT_EQ(read[1].reason, HighlightStatus::kGrazing);
  EXPECT_EQ(read[1].cam_from_world.translation, scene.views[2].cam_from_world.translation);
  EXPECT_THROW(ReadContacts(folder_ / "contacts.json", scene, 4, 10), InputError);
  EXPECT_THROW(ReadContacts(folder_ / "contacts.json", scene, 10, 0), InputError);
  scene.views.resize(2);
  EXPECT_THROW(ReadContacts(folder_ / "contacts.json", scene, 10, 10), InputError);
  Write("contacts.json", std::string(100000, '[') + std::string(100000, ']'));
  EXPECT_THROW(ReadContacts(folder_ / "contacts.json", scene, 10, 10), InputError);
  Write("contacts.json", "[{}]");
  EXPECT_THROW(ReadContacts(folder_ / "contacts.json", scene, 10, 10), InputError);
  EXPECT_THROW(ReadContacts(folder_ / "none.json", scene, 10, 10), InputError);
}

}  // namespace
}  // namespace glint
