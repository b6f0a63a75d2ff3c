#include "refine/turn.h"

#include <gtest/gtest.h>

#include "sdf/mesh_to_level_set.h"
#include "tests/support/shapes.h"

namespace glint {
namespace {

TEST(LargestTurn, IsTheWayOverTheRadius) {
  TriangleMesh lens = testing::Icosphere(5);
  const LevelSet ball = MeshToLevelSet(lens, 0.04, {});
  EXPECT_NEAR(LargestTurn(ball, {0, 0, 1}, {0, 0, 1}, 0.1), 0.2, 0.02);
  for (Eigen::Vector3d& x : lens.vertices) x.z() *= 0.25;  // radius 4 on top, 1/16 across the rim
  const LevelSet flat = MeshToLevelSet(lens, 0.02, {});
  EXPECT_NEAR(LargestTurn(flat, {0, 0, 0.25}, {0, 0, 1}, 0.04), 0.02, 0.005);
  EXPECT_GT(LargestTurn(flat, {1, 0, 0}, {1, 0, 0}, 0.04), 0.7);
}

TEST(LargestTurn, NothingIsKnownOutsideOfTheBand) {
  const LevelSet ball = MeshToLevelSet(testing::Icosphere(3), 0.05, {});
  EXPECT_EQ(LargestTurn(ball, {3, 0, 0}, {1, 0, 0}, 0.05), 0);
}

}  // namespace
}  // namespace glint
