#include "refine/thickness.h"

#include <gtest/gtest.h>

#include "sdf/mesh_to_level_set.h"
#include "tests/support/ball_mesh.h"

namespace glint {
namespace {

// A plate about the origin: its mesh and its distances.
class Plate : public ::testing::Test {
 protected:
  static TriangleMesh Box(const Eigen::Vector3d& half) {
    TriangleMesh mesh;
    for (int c = 0; c < 8; ++c)
      mesh.vertices.emplace_back(c & 1 ? half.x() : -half.x(), c & 2 ? half.y() : -half.y(),
                                 c & 4 ? half.z() : -half.z());
    mesh.faces = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                  {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    return mesh;
  }

  static constexpr double kThickness = 0.03, kVoxel = 0.01;
  const TriangleMesh plate_ = Box({0.5, 0.5, kThickness / 2});
  const LevelSet field_ = MeshToLevelSet(plate_, kVoxel);
};

TEST_F(Plate, IsAsThinAsItIs) {
  EXPECT_NEAR(ThinnestWalls(plate_), kThickness, 1e-3);
  EXPECT_GT(ThinnestWalls(testing::BallMesh({0, 0, 0}, 1, 20)), 1.9);
}

TEST_F(Plate, IsHeldWhereTheSeedIsFineAndVoxelsAreFew) {
  const Eigen::Vector3d corner(0.5, 0.5, kThickness / 2);
  const Unresolved held(plate_, field_, {corner});
  EXPECT_TRUE(held.Near(corner));
  EXPECT_FALSE(held.Near({-0.5, -0.5, 0}));  // not fine there
  EXPECT_FALSE(Unresolved(plate_, field_, {}).Near(corner));
}

TEST_F(Plate, ABodyWithRoomForTheVoxelsIsNotHeld) {
  const TriangleMesh ball = testing::BallMesh({0, 0, 0}, 1, 40);
  const LevelSet field = MeshToLevelSet(ball, 0.05);
  EXPECT_FALSE(Unresolved(ball, field, ball.vertices).Near({0, 0, 1}));
}

}  // namespace
}  // namespace glint
