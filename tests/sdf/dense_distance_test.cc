#include "sdf/dense_distance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/error.h"
#include "core/parallel.h"
#include "tests/geometry/test_meshes.h"
#include "tests/sdf/brute_force.h"

namespace glint {
namespace {

Eigen::Affine3d Frame(double voxel_size, const Eigen::Vector3d& first) {
  Eigen::Affine3d world_from_index = Eigen::Affine3d::Identity();
  world_from_index.linear() *= voxel_size;
  world_from_index.translation() = first;
  return world_from_index;
}

void ExpectTrue(const TriangleMesh& mesh, const Eigen::Affine3d& world_from_index, const Eigen::Vector3i& size,
                const std::string& sign) {
  const DenseField field = DenseSignedDistance(mesh, world_from_index, size, sign);
  ASSERT_EQ(field.values.size(), static_cast<size_t>(size.prod()));
  double worst = 0;
  int wrong = 0;
  for (int x = 0; x < size[0]; ++x)
    for (int y = 0; y < size[1]; ++y)
      for (int z = 0; z < size[2]; ++z) {
        const Eigen::Vector3d p = world_from_index * Eigen::Vector3d(x, y, z);
        const double value = field(x, y, z), d = testing::BruteDistance(mesh, p);
        worst = std::max(worst, std::abs(std::abs(value) - d));
        const bool inside = sign != "unsigned" && testing::BruteInside(mesh, p);
        wrong += d > 1e-6 * Diagonal(mesh) && (value < 0) != inside;
      }
  EXPECT_LT(worst, 1e-6 * Diagonal(mesh)) << sign;
  EXPECT_EQ(wrong, 0) << sign;
}

TEST(DenseDistance, ExactFarAndNear) {
  const TriangleMesh spiky = testing::SpikySphere(2, 0.6, 3);
  for (const char* sign : {"pseudonormal", "winding", "unsigned", "auto"})
    ExpectTrue(spiky, Frame(0.31, {-3, -2.6, -2.9}), {19, 16, 21}, sign);
  ExpectTrue(testing::Icosphere(4), Frame(0.12, {-1.4, -1.4, -1.4}), {24, 24, 24}, "auto");
}

TEST(DenseDistance, ScalesAndOffsets) {
  for (double scale : {1e-8, 1e-3, 1.0, 1e6}) {
    const Eigen::Vector3d offset = scale * 1e6 * Eigen::Vector3d(1, -0.7, 0.3);
    ExpectTrue(testing::Transformed(testing::SpikySphere(2, 0.5, 4), scale, offset),
               Frame(0.2 * scale, offset - 1.6 * scale * Eigen::Vector3d::Ones()), {16, 16, 16}, "auto");
  }
}

TEST(DenseDistance, BoxAwayFromTheMesh) {
  ExpectTrue(testing::Icosphere(2), Frame(0.5, {20, 1, -3}), {9, 8, 7}, "pseudonormal");
}

TEST(DenseDistance, RotatedFrame) {
  Eigen::Affine3d frame = Frame(0.2, {-1.5, -1.2, -2});
  frame.linear() *= Eigen::AngleAxisd(0.8, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix();
  ExpectTrue(testing::SpikySphere(1, 0.5, 6), frame, {14, 15, 16}, "auto");
}

TEST(DenseDistance, SameAtAnyNumberOfThreads) {
  const TriangleMesh mesh = testing::SpikySphere(3, 0.3, 2);
  const ThreadLimit one(1);
  const DenseField a = DenseSignedDistance(mesh, Frame(0.1, {-1.5, -1.5, -1.5}), {30, 30, 30});
  const ThreadLimit two(2);
  EXPECT_EQ(a.values, DenseSignedDistance(mesh, Frame(0.1, {-1.5, -1.5, -1.5}), {30, 30, 30}).values);
}

TEST(DenseDistance, InvertedMeshIsTurned) {
  SdfSummary summary;
  const DenseField field = DenseSignedDistance(testing::Inverted(testing::Icosphere(2)), Frame(0.5, {-1, -1, -1}),
                                               {5, 5, 5}, "auto", &summary);
  EXPECT_TRUE(summary.turned);
  EXPECT_EQ(summary.sign, "pseudonormal");
  EXPECT_LT(field(2, 2, 2), 0);
}

TEST(DenseDistance, BadInputIsRefused) {
  const TriangleMesh box = testing::Box({0, 0, 0}, {1, 1, 1});
  EXPECT_THROW(DenseSignedDistance(box, Frame(0.1, {0, 0, 0}), {4, 0, 4}), InputError);
  EXPECT_THROW(DenseSignedDistance(box, Frame(0.1, {0, 0, 0}), {1 << 20, 1 << 20, 1 << 20}), InputError);
  EXPECT_THROW(DenseSignedDistance(box, Frame(0, {0, 0, 0}), {4, 4, 4}), InputError);
  EXPECT_THROW(DenseSignedDistance(box, Frame(0.1, {std::nan(""), 0, 0}), {4, 4, 4}), InputError);
  EXPECT_THROW(DenseSignedDistance(box, Frame(0.1, {0, 0, 0}), {4, 4, 4}, "guess"), InputError);
  EXPECT_THROW(DenseSignedDistance(TriangleMesh(), Frame(0.1, {0, 0, 0}), {4, 4, 4}), InputError);
  TriangleMesh bad = box;
  bad.vertices[0][1] = std::numeric_limits<double>::infinity();
  EXPECT_THROW(DenseSignedDistance(bad, Frame(0.1, {0, 0, 0}), {4, 4, 4}), InputError);
}

}  // namespace
}  // namespace glint
