#include "geometry/closest_point.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/geometry/test_meshes.h"

namespace glint {
namespace {

using Eigen::Vector3d;

const Vector3d kA(0, 0, 0), kB(4, 0, 0), kC(0, 3, 0);

void ExpectAt(const Vector3d& p, Feature feature, int corner, const Vector3d& closest) {
  const TrianglePoint at = ClosestOnTriangle(kA, kB, kC, p);
  EXPECT_EQ(at.feature, feature) << p.transpose();
  EXPECT_EQ(at.corner, corner) << p.transpose();
  EXPECT_LT((at.point - closest).norm(), 1e-14);
  EXPECT_NEAR(at.squared_distance, (p - closest).squaredNorm(), 1e-12);
}

TEST(ClosestOnTriangle, AllFeatures) {
  for (double z : {0.0, 2.0, -3.0}) {
    ExpectAt({1, 1, z}, Feature::kFace, 0, {1, 1, 0});
    ExpectAt({2, -1, z}, Feature::kEdge, 0, {2, 0, 0});
    ExpectAt({3.6, 2.8, z}, Feature::kEdge, 1, {2.4, 1.2, 0});
    ExpectAt({-2, 1, z}, Feature::kEdge, 2, {0, 1, 0});
    ExpectAt({-1, -1, z}, Feature::kVertex, 0, kA);
    ExpectAt({6, -1, z}, Feature::kVertex, 1, kB);
    ExpectAt({-1, 5, z}, Feature::kVertex, 2, kC);
  }
}

TEST(ClosestOnTriangle, PointsOnItsFeatures) {
  ExpectAt(kA, Feature::kVertex, 0, kA);
  ExpectAt(kB, Feature::kVertex, 1, kB);
  ExpectAt(kC, Feature::kVertex, 2, kC);
  ExpectAt({2, 0, 0}, Feature::kEdge, 0, {2, 0, 0});
  ExpectAt({0, 1, 0}, Feature::kEdge, 2, {0, 1, 0});
}

TEST(ClosestOnTriangle, WithoutArea) {
  // A segment, in all orders of its corners; the middle one may be any vertex.
  const Vector3d p(1, 1, 0), ends[3] = {{0, 0, 0}, {1, 0, 0}, {3, 0, 0}};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      if (i == j) continue;
      const TrianglePoint at = ClosestOnTriangle(ends[i], ends[j], ends[3 - i - j], p);
      EXPECT_NEAR(at.squared_distance, 1, 1e-14);
      EXPECT_NE(at.feature, Feature::kFace);
      EXPECT_LT((at.point - Vector3d(1, 0, 0)).norm(), 1e-14);
    }
  // Two corners in one place, and all three.
  EXPECT_NEAR(ClosestOnTriangle(kA, kA, kB, {2, 1, 0}).squared_distance, 1, 1e-14);
  EXPECT_NEAR(ClosestOnTriangle(kA, kB, kB, {2, 1, 0}).squared_distance, 1, 1e-14);
  const TrianglePoint point = ClosestOnTriangle(kB, kB, kB, {4, 3, 4});
  EXPECT_EQ(point.feature, Feature::kVertex);
  EXPECT_NEAR(point.squared_distance, 25, 1e-13);
  EXPECT_TRUE(Barycentric(kB, kB, kB, kB).allFinite());
}

// Against the least over a fine grid of the triangle's points, for all shapes of triangles.
TEST(ClosestOnTriangle, NoPointOfTheTriangleIsCloser) {
  std::mt19937 random(3);
  const auto uniform = [&] { return 2.0 * random() / 4294967295.0 - 1; };
  for (int i = 0; i < 3000; ++i) {
    const Vector3d a(uniform(), uniform(), uniform()), b(uniform(), uniform(), uniform());
    const double height = std::pow(10, -16 * std::abs(uniform()));
    const Vector3d c = a + uniform() * 2 * (b - a) + height * Vector3d(uniform(), uniform(), uniform());
    const Vector3d p(2 * uniform(), 2 * uniform(), 2 * uniform());
    const TrianglePoint at = ClosestOnTriangle(a, b, c, p);
    EXPECT_NEAR((p - at.point).norm(), std::sqrt(at.squared_distance), 1e-12);
    const Vector3d weights = Barycentric(a, b, c, at.point);
    EXPECT_NEAR(weights.sum(), 1, 1e-12);
    double least = 1e300;
    constexpr int n = 12;
    for (int u = 0; u <= n; ++u)
      for (int v = 0; u + v <= n; ++v) least = std::min(least, (a + (b - a) * u / n + (c - a) * v / n - p).norm());
    EXPECT_LE(std::sqrt(at.squared_distance), least + 1e-12);
    EXPECT_GE(std::sqrt(at.squared_distance), least - ((b - a).norm() + (c - a).norm()) / n);
    if (height < 1e-3) continue;
    EXPECT_GT(weights.minCoeff(), -1e-9);
    EXPECT_LT((weights[0] * a + weights[1] * b + weights[2] * c - at.point).norm(), 1e-9);
    // The feature says which weights are zero.
    if (at.feature == Feature::kVertex) {
      EXPECT_NEAR(weights[at.corner], 1, 1e-9);
    }
    if (at.feature == Feature::kEdge) {
      EXPECT_NEAR(weights[(at.corner + 2) % 3], 0, 1e-9);
    }
  }
}

TEST(ClosestPointQuery, AsBruteForce) {
  const TriangleMesh mesh = testing::SpikySphere(3, 0.5, 8);
  const ClosestPointQuery query(mesh);
  std::mt19937 random(3);
  const auto uniform = [&] { return 2.0 * random() / 4294967295.0 - 1; };
  for (int i = 0; i < 300; ++i) {
    const Vector3d p(2 * uniform(), 2 * uniform(), 2 * uniform());
    double best = 1e300;
    for (const Eigen::Vector3i& f : mesh.faces)
      best = std::min(
          best, ClosestOnTriangle(mesh.vertices[f[0]], mesh.vertices[f[1]], mesh.vertices[f[2]], p).squared_distance);
    const auto at = query.Find(p);
    ASSERT_TRUE(at.has_value());
    EXPECT_EQ(at->squared_distance, best);
    const int anywhere = static_cast<int>(random() % mesh.faces.size());
    EXPECT_EQ(query.Find(p, 10, anywhere)->squared_distance, best);
    EXPECT_FALSE(query.Find(p, 0.999 * std::sqrt(best)).has_value());
    EXPECT_TRUE(query.Find(p, 1.001 * std::sqrt(best)).has_value());
  }
  EXPECT_FALSE(ClosestPointQuery(TriangleMesh()).Find({0, 0, 0}).has_value());
}

}  // namespace
}  // namespace glint
