#include "refine/thickness.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "refine/level_set_step.h"
#include "sdf/field_mesh.h"
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

TEST_F(Plate, IsHeldWhereTheFieldHasNoDirection) {
  TriangleMesh sheet;
  sheet.vertices = {{0, 0, 0}, {0.1, 0, 0}, {0, 0.1, 0}};
  sheet.faces = {{0, 1, 2}};
  const Eigen::Vector3d middle(0, 0, 0);
  ASSERT_EQ(field_.Gradient(middle).norm(), 0);
  EXPECT_TRUE(Unresolved(sheet, field_, {middle}).Near(middle));
}

TEST_F(Plate, ABodyWithRoomForTheVoxelsIsNotHeld) {
  const TriangleMesh ball = testing::BallMesh({0, 0, 0}, 1, 40);
  const LevelSet field = MeshToLevelSet(ball, 0.05);
  EXPECT_FALSE(Unresolved(ball, field, ball.vertices).Near({0, 0, 1}));
}

// A plate with a round edge of less than two voxels: with nothing known but the seed, a step leaves it as it is.
TEST(HeldEdge, KeepsItsShape) {
  constexpr double kRadius = 0.018, kVoxel = 0.01, kCell = 0.004, kHalf = 0.2;
  DenseField plate{{120, 120, 24}, {}};
  Eigen::Affine3d world_from_index = Eigen::Affine3d::Identity();
  world_from_index.linear() *= kCell;
  world_from_index.translation() = -0.5 * kCell * Eigen::Vector3d(119, 119, 23);
  for (int i = 0; i < plate.size[0] * plate.size[1] * plate.size[2]; ++i) {
    const Eigen::Vector3d x = world_from_index * Eigen::Vector3d(i / plate.size[2] / plate.size[1],
                                                                 i / plate.size[2] % plate.size[1], i % plate.size[2]);
    const Eigen::Vector3d beyond(std::max(std::abs(x.x()) - kHalf, 0.0), std::max(std::abs(x.y()) - kHalf, 0.0), x.z());
    plate.values.push_back(static_cast<float>(beyond.norm() - kRadius));
  }
  const TriangleMesh mesh = MeshOfField(plate, world_from_index, 0);
  const LevelSet field = MeshToLevelSet(mesh, kVoxel, {.half_width_voxels = 3});
  const LevelSet seed = MeshToLevelSet(mesh, kVoxel, {.half_width_voxels = 6});
  const Unresolved held(mesh, field, mesh.vertices);
  const std::vector<OrientedPoint> none;
  const std::vector<SurfacePoint> no_points;
  const LevelSet stepped = VariationalStep(
      {field, seed, Bend::kLikeSeed, SurfaceArea(mesh), none, no_points, none, StepInput::kNoTilts, &held}, {},
      nullptr);
  double turned = 0;
  int on_edge = 0;
  for (const Eigen::Vector3d& v : mesh.vertices) {
    if (std::max(std::abs(v.x()), std::abs(v.y())) < kHalf) continue;
    turned += std::acos(std::clamp(stepped.Gradient(v).normalized().dot(field.Gradient(v).normalized()), -1.0, 1.0));
    ++on_edge;
  }
  ASSERT_GT(on_edge, 500);
  EXPECT_LT(turned / on_edge, 0.1 * M_PI / 180);
}

}  // namespace
}  // namespace glint
