#include "pipeline/advice.h"

#include <gmock/gmock.h>

namespace glint {
namespace {

using ::testing::Contains;
using ::testing::Field;
using ::testing::HasSubstr;
using ::testing::Not;

// A run of 40 views all around an object at the origin, with nothing to complain of.
struct GoodRun {
  RunSummary summary;
  Scene scene;
  std::vector<Contact> contacts;
  std::vector<Light> lights;
  TriangleMesh mesh;

  GoodRun() {
    summary.outcome = "done";
    summary.num_views = 40;
    summary.diagonal_world = 1;
    summary.num_candidates = 60;
    summary.highlights_by_status[static_cast<size_t>(HighlightStatus::kAccepted)] = 60;
    summary.refine.num_highlights = 60;
    summary.refine.converged = true;
    summary.refine.iterations.emplace_back();
    lights.emplace_back().vector = Eigen::Vector3d::UnitZ();
    summary.lights.emplace_back().light = lights[0];
    scene.points.emplace_back().position = Eigen::Vector3d::Zero();
    for (int i = 0; i < 40; ++i) {
      const double turn = 2 * M_PI * i / 40;
      View& view = scene.views.emplace_back();
      // The centre is −Rᵀ t.
      view.cam_from_world.translation = -Eigen::Vector3d(3 * std::cos(turn), 3 * std::sin(turn), 1);
    }
    for (int i = 0; i < 60; ++i) {
      const double turn = 2 * M_PI * i / 60;
      Contact& contact = contacts.emplace_back();
      contact.origin = {3 * std::cos(turn), 3 * std::sin(turn), -1};
      contact.direction = -contact.origin.normalized();
      contact.cam_from_world.translation = -contact.origin;
      contact.depth = 2;
    }
    mesh.confidence.assign(100, 0.8f);
  }

  std::vector<Advice> Give() const { return GiveAdvice(summary, scene, contacts, lights, mesh); }
};

auto Finding(const char* part) { return Contains(Field(&Advice::finding, HasSubstr(part))); }

TEST(Advice, NothingToComplainOf) {
  const std::vector<Advice> advice = GoodRun().Give();
  ASSERT_EQ(advice.size(), 1);
  EXPECT_EQ(advice[0].level, AdviceLevel::kGood) << advice[0].finding;
}

TEST(Advice, ARunWithoutResultComesFirst) {
  GoodRun run;
  run.summary.outcome = "no highlights found in any image";
  run.summary.num_candidates = 0;
  run.summary.num_views = 5;
  run.contacts.clear();
  const std::vector<Advice> advice = run.Give();
  EXPECT_EQ(advice[0].level, AdviceLevel::kProblem);
  EXPECT_THAT(advice[0].finding, HasSubstr("no highlights found in any image"));
  EXPECT_THAT(advice[0].cure, HasSubstr("lamp"));
  EXPECT_THAT(advice, Finding("only 5 photographs"));
  EXPECT_THAT(advice, Not(Finding("highlights could be used")));
}

TEST(Advice, HighlightsOnOneSide) {
  GoodRun run;
  EXPECT_THAT(run.Give(), Not(Finding("one side")));
  for (Contact& contact : run.contacts) {
    contact.origin = {0.2 * contact.origin.x(), 0.2 * contact.origin.y(), 3};
    contact.direction = -contact.origin.normalized();
    contact.cam_from_world.translation = -contact.origin;
  }
  EXPECT_THAT(run.Give(), Finding("All highlights lie on one side"));
}

TEST(Advice, CamerasOnOneSide) {
  GoodRun run;
  for (View& view : run.scene.views) view.cam_from_world.translation.z() = -20;
  EXPECT_THAT(run.Give(), Finding("look from one side"));
}

TEST(Advice, FewHighlightsAndMissingPhotographs) {
  GoodRun run;
  run.contacts.resize(7);
  run.summary.num_missing_images = 3;
  EXPECT_THAT(run.Give(), Finding("Only 7 highlights"));
  EXPECT_THAT(run.Give(), Finding("3 of 40 photographs are missing"));
}

TEST(Advice, LightsThatAreNotWellKnown) {
  GoodRun run;
  run.summary.lights[0].light.sigma = 4;
  EXPECT_THAT(run.Give(), Finding("light 0 is known to 4.0° only"));
  run.summary.lights[0].light.type = LightType::kPoint;
  run.summary.lights[0].light.sigma = 0.5;
  EXPECT_THAT(run.Give(), Finding("light 0 is known to 50 %"));
  run.summary.lights[0].determined = false;
  run.summary.lights[0].why = "3 highlights support it";
  EXPECT_THAT(run.Give(), Finding("not determined and was not used: 3 highlights support it"));
}

TEST(Advice, OneReasonForMostRejections) {
  GoodRun run;
  run.summary.num_candidates = 200;
  run.summary.highlights_by_status[static_cast<size_t>(HighlightStatus::kOffSurface)] = 140;
  EXPECT_THAT(run.Give(), Finding("140 of 200 bright spots were rejected for one reason: its ray misses the surface"));
}

TEST(Advice, SurfaceThatNoHighlightReaches) {
  GoodRun run;
  run.mesh.confidence.assign(100, 0.05f);
  run.summary.refine.converged = false;
  run.summary.refine.iterations.back().contact_motion_voxels = 0.75;
  EXPECT_THAT(run.Give(), Finding("normals of 100 % of the surface are known to no better than 10°"));
  EXPECT_THAT(run.Give(), Finding("still moved by 0.75 voxels"));
}

TEST(Advice, WarningsOfTheRunAreRepeated) {
  GoodRun run;
  run.summary.warnings.push_back("camera 3 is odd");
  const std::vector<Advice> advice = run.Give();
  EXPECT_EQ(advice[0].level, AdviceLevel::kWarning);
  EXPECT_EQ(advice[0].finding, "camera 3 is odd");
}

}  // namespace
}  // namespace glint
