#include "geometry/pseudo_normals.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "core/parallel.h"
#include "geometry/winding_number.h"
#include "tests/geometry/test_meshes.h"
#include "tests/geometry/weighted_normals.h"

namespace glint {
namespace {

using testing::Weighting;

PseudoNormals NormalsOf(const TriangleMesh& mesh) { return ComputePseudoNormals(mesh, BuildEdgeTopology(mesh)); }

TEST(PseudoNormals, OfABox) {
  const TriangleMesh box = testing::Box({0, 0, 0}, {1, 2, 3});
  const PseudoNormals normals = NormalsOf(box);
  for (size_t v = 0; v < 8; ++v) {  // three right angles, however the sides are cut in two
    const Eigen::Vector3d out(v & 1 ? 1 : -1, v & 2 ? 1 : -1, v & 4 ? 1 : -1);
    EXPECT_LT((normals.vertex[v] - std::numbers::pi / 2 * out).norm(), 1e-12);
  }
  for (size_t f = 0; f < box.faces.size(); ++f) {
    EXPECT_NEAR(normals.face[f].norm(), 1, 1e-15);
    for (int k = 0; k < 3; ++k) {
      const double length = normals.edge[f][static_cast<size_t>(k)].norm();
      EXPECT_TRUE(std::abs(length - 2) < 1e-12 || std::abs(length - std::numbers::sqrt2) < 1e-12);
    }
  }
}

// What makes them independent of the triangulation: cutting a face leaves the vertex normal as it is.
TEST(PseudoNormals, CuttingFacesChangesNothing) {
  const PseudoNormals one = NormalsOf(testing::Needle(1, 3)), many = NormalsOf(testing::Needle(50, 3));
  EXPECT_LT((one.vertex[0] - many.vertex[0]).norm(), 1e-12);
}

TEST(PseudoNormals, ThinTrianglesHaveAccurateNormals) {
  for (double height : {1e-3, 1e-9, 1e-14, 1e-30, 1e-200}) {
    const Eigen::Vector3d n = AccurateNormal({0, 0, 0}, {1, 0, 0}, {0.3, 0.6 * height, 0.8 * height});
    EXPECT_LT((n - Eigen::Vector3d(0, -0.8, 0.6)).norm(), 1e-12) << height;
  }
  EXPECT_TRUE(AccurateNormal({0, 0, 0}, {1, 1, 1}, {2, 2, 2}).isZero(0));
  EXPECT_TRUE(AccurateNormal({1, 2, 3}, {1, 2, 3}, {1, 2, 3}).isZero(0));
}

TEST(PseudoNormals, Angles) {
  EXPECT_NEAR(CornerAngle({0, 0, 0}, {1, 0, 0}, {0, 2, 0}), std::numbers::pi / 2, 1e-15);
  EXPECT_NEAR(CornerAngle({0, 0, 0}, {1, 0, 0}, {1, 1e-9, 0}), 1e-9, 1e-20);
  EXPECT_NEAR(CornerAngle({0, 0, 0}, {1, 0, 0}, {-1, 1e-9, 0}), std::numbers::pi - 1e-9, 1e-15);
  EXPECT_EQ(CornerAngle({0, 0, 0}, {0, 0, 0}, {1, 0, 0}), 0);
}

TEST(PseudoNormals, SameAtAnyNumberOfThreads) {
  const TriangleMesh mesh = testing::SpikySphere(5, 0.3, 1);
  const ThreadLimit one(1);
  const PseudoNormals a = NormalsOf(mesh);
  const ThreadLimit two(2);
  const PseudoNormals b = NormalsOf(mesh);
  for (size_t v = 0; v < mesh.vertices.size(); ++v) ASSERT_EQ(a.vertex[v], b.vertex[v]);
  for (size_t f = 0; f < mesh.faces.size(); ++f) ASSERT_EQ(a.edge[f], b.edge[f]);
}

// Random points, most of them near vertices and edges.
std::vector<Eigen::Vector3d> PointsAbout(const TriangleMesh& mesh, size_t count, double reach) {
  std::mt19937 random(5);
  const auto uniform = [&] { return 2.0 * random() / 4294967295.0 - 1; };
  std::vector<Eigen::Vector3d> points(count);
  for (size_t i = 0; i < count; ++i)
    points[i] =
        mesh.vertices[random() % mesh.vertices.size()] + reach * Eigen::Vector3d(uniform(), uniform(), uniform());
  return points;
}

size_t WrongSigns(const TriangleMesh& mesh, Weighting weighting, const std::vector<Eigen::Vector3d>& points) {
  const testing::WeightedSign sign(mesh, weighting);
  const ClosestPointQuery closest(mesh);
  return ParallelSum(points.size(), 256, size_t{0}, [&](size_t begin, size_t end) {
    size_t wrong = 0;
    for (size_t i = begin; i < end; ++i) {
      const auto at = closest.Find(points[i]);
      if (at->squared_distance < 1e-24) continue;
      wrong += sign.Inside(points[i], *at) != (std::lround(ExactWindingNumber(mesh, points[i])) > 0);
    }
    return wrong;
  });
}

// The paper's point: for every other weighting there are meshes that it signs wrongly.
TEST(WhyAngleWeights, FaceNormalsFailAtAnySharpTip) {
  const TriangleMesh needle = testing::Needle(1, 1);
  const auto points = PointsAbout(needle, 4000, 0.2);
  EXPECT_GT(WrongSigns(needle, Weighting::kFace, points), 50u);
  EXPECT_EQ(WrongSigns(needle, Weighting::kAngle, points), 0u);
}

TEST(WhyAngleWeights, MeanNormalsFailWhereAFaceIsCutUp) {
  const TriangleMesh needle = testing::Needle(30, 1);
  const auto points = PointsAbout(needle, 4000, 0.2);
  EXPECT_GT(WrongSigns(needle, Weighting::kMean, points), 20u);
  EXPECT_EQ(WrongSigns(needle, Weighting::kAngle, points), 0u);
}

TEST(WhyAngleWeights, AreaWeightsFailWhereAFaceIsLong) {
  const TriangleMesh needle = testing::Needle(1, 30);
  const auto points = PointsAbout(needle, 4000, 0.2);
  EXPECT_GT(WrongSigns(needle, Weighting::kArea, points), 20u);
  EXPECT_EQ(WrongSigns(needle, Weighting::kAngle, points), 0u);
}

TEST(WhyAngleWeights, AngleWeightsNeverFail) {
  size_t others = 0;
  for (unsigned seed = 0; seed < 4; ++seed)
    for (bool inverted : {false, true}) {  // sharp dents as well as sharp tips
      TriangleMesh mesh = testing::SpikySphere(2, 0.8, seed);
      if (inverted) mesh = testing::Joined(testing::Box({-4, -4, -4}, {4, 4, 4}), testing::Inverted(mesh));
      const auto points = PointsAbout(mesh, 3000, 0.1);
      EXPECT_EQ(WrongSigns(mesh, Weighting::kAngle, points), 0u) << seed;
      for (Weighting w : {Weighting::kFace, Weighting::kMean, Weighting::kArea}) others += WrongSigns(mesh, w, points);
    }
  EXPECT_GT(others, 100u);
}

}  // namespace
}  // namespace glint
