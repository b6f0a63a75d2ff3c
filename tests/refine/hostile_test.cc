// What refinement must survive: whatever it is given, the surface stays finite and near what it was, and is told of.
#include <gtest/gtest.h>

#include <cmath>

#include "geometry/closest_point.h"
#include "tests/refine/ellipsoid_problem.h"

namespace glint {
namespace {

using testing::DistantLight;
using testing::MakeProblem;
using testing::Problem;

RefineOptions QuickOptions() {
  RefineOptions options;
  options.voxel_rel = 1.0 / 40;
  options.levels = 1;
  options.max_iterations = 2;
  return options;
}

// Every value that leaves is a number, and no vertex is farther from the seed than that (diagonals).
void ExpectSane(const Problem& p, const RefineResult& result, double farthest_rel) {
  ASSERT_FALSE(result.mesh.faces.empty());
  const ClosestPointQuery seed(p.seed);
  const double farthest = farthest_rel * Diagonal(p.seed);
  for (size_t v = 0; v < result.mesh.vertices.size(); ++v) {
    ASSERT_TRUE(result.mesh.vertices[v].allFinite());
    ASSERT_TRUE(result.mesh.normals[v].allFinite());
    ASSERT_LT((seed.Find(result.mesh.vertices[v])->point - result.mesh.vertices[v]).norm(), farthest);
  }
  for (const auto& [name, values] : result.mesh.scalars)
    for (const float value : values) ASSERT_TRUE(std::isfinite(value)) << name;
  for (const Light& light : result.lights) ASSERT_TRUE(light.vector.allFinite());
  for (const IterationSummary& iteration : result.summary.iterations) {
    ASSERT_TRUE(std::isfinite(iteration.step.energy_after));
    ASSERT_TRUE(std::isfinite(iteration.contact_motion_voxels));
  }
}

TEST(RefineHostile, EverySecondHighlightIsSomewhereElse) {
  Problem p = MakeProblem();
  for (size_t i = 0; i < p.highlights.size(); i += 2) p.highlights[i].px += Eigen::Vector2d(i % 4 ? 45 : -45, 30);
  const RefineResult result = Refine(p.Input(), QuickOptions());
  ExpectSane(p, result, 0.06);
  EXPECT_LT(result.contacts.size(), p.highlights.size());
  // What is left out says why.
  size_t rejected = 0;
  for (const Highlight& h : result.highlights) rejected += h.status != HighlightStatus::kAccepted;
  EXPECT_EQ(rejected + result.contacts.size(), p.highlights.size());
}

// Consistently wrong data are followed (in a run the gate comes first), but not without end.
TEST(RefineHostile, TheLightsAreAltogetherWrong) {
  Problem p = MakeProblem();
  p.lights = {DistantLight(-1, -0.8, 0.1), DistantLight(0.2, -1, -0.3)};
  ExpectSane(p, Refine(p.Input(), QuickOptions()), 0.2);
}

TEST(RefineHostile, ASphereForASeed) {
  Problem p = MakeProblem();
  p.seed = testing::Icosphere(4);
  for (Eigen::Vector3d& v : p.seed.vertices) v *= 1.3;
  ExpectSane(p, Refine(p.Input(), QuickOptions()), 0.3);
}

TEST(RefineHostile, ASeedThatMissesTheObjectStays) {
  Problem p = MakeProblem();
  for (Eigen::Vector3d& v : p.seed.vertices) v += Eigen::Vector3d(40, 0, 0);
  const RefineResult result = Refine(p.Input(), QuickOptions());
  EXPECT_TRUE(result.contacts.empty());
  ExpectSane(p, result, 0.05);
}

TEST(RefineHostile, ASeedAsFlatAsACoin) {
  Problem p = MakeProblem();
  for (Eigen::Vector3d& v : p.seed.vertices) v.z() *= 0.03;
  ExpectSane(p, Refine(p.Input(), QuickOptions()), 0.5);
}

TEST(RefineHostile, OneHighlightAndNoPoint) {
  Problem p = MakeProblem();
  p.highlights.resize(1);
  p.point_used.clear();
  ExpectSane(p, Refine(p.Input(), QuickOptions()), 0.06);
}

}  // namespace
}  // namespace glint
