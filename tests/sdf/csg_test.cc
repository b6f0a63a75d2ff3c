#include "sdf/csg.h"

#include <gtest/gtest.h>

#include <cmath>

#include "geometry/components.h"
#include "geometry/edge_topology.h"
#include "sdf/field_mesh.h"
#include "tests/support/ball_mesh.h"

namespace glint {
namespace {

using testing::BallMesh;

constexpr double kBall = 4 * M_PI / 3;
constexpr double kLens = 5 * M_PI / 12;  // common to two unit balls one apart

class Csg : public ::testing::Test {
 protected:
  const TriangleMesh a_ = BallMesh({0, 0, 0}, 1, 60), b_ = BallMesh({0, 0, 1}, 1, 60);
};

TEST_F(Csg, JoinsVolumes) {
  const TriangleMesh both = Union(a_, b_, 0.02);
  EXPECT_TRUE(EdgesBalanced(both));
  EXPECT_NEAR(SignedVolume(both), 2 * kBall - kLens, 0.005 * kBall);
}

TEST_F(Csg, TakesOneFromTheOther) {
  const TriangleMesh rest = Difference(a_, b_, 0.02);
  EXPECT_TRUE(EdgesBalanced(rest));
  EXPECT_NEAR(SignedVolume(rest), kBall - kLens, 0.005 * kBall);
  EXPECT_TRUE(Difference(a_, BallMesh({0, 0, 0}, 2, 60), 0.05).empty());
}

TEST_F(Csg, ClosesWhatIsNarrow) {
  const TriangleMesh apart = Union(a_, BallMesh({0, 0, 2.05}, 1, 60), 0.02);
  const auto pieces = [](const TriangleMesh& mesh) {
    return FindComponents(mesh, BuildEdgeTopology(mesh)).list.size();
  };
  EXPECT_EQ(pieces(apart), 2u);
  const TriangleMesh closed = Closing(apart, 0.02, 0.06);
  EXPECT_EQ(pieces(closed), 1u);
  EXPECT_TRUE(EdgesBalanced(closed));
  EXPECT_NEAR(SignedVolume(closed), 2 * kBall, 0.01 * kBall);
  EXPECT_EQ(pieces(Closing(apart, 0.02, 0.02)), 2u);
}

TEST(FieldMesh, IsTheLevelOfTheField) {
  DenseField field{{40, 30, 35}, {}};
  Eigen::Affine3d world_from_index = Eigen::Affine3d::Identity();
  world_from_index.linear() *= 0.1;
  world_from_index.translation() = Eigen::Vector3d(-2, -1.5, -1.7);
  for (int x = 0; x < 40; ++x)
    for (int y = 0; y < 30; ++y)
      for (int z = 0; z < 35; ++z)
        field.values.push_back(static_cast<float>((world_from_index * Eigen::Vector3d(x, y, z)).norm()));
  const TriangleMesh mesh = MeshOfField(field, world_from_index, 1.2);
  EXPECT_TRUE(EdgesBalanced(mesh));
  EXPECT_NEAR(SignedVolume(mesh), kBall * std::pow(1.2, 3), 0.02 * kBall);
  for (const Eigen::Vector3d& x : mesh.vertices) EXPECT_NEAR(x.norm(), 1.2, 0.02);
}

}  // namespace
}  // namespace glint
