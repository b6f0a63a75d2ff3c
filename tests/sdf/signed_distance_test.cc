#include "sdf/signed_distance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "core/error.h"
#include "core/parallel.h"
#include "sdf/level_set_impl.h"
#include "tests/geometry/test_meshes.h"
#include "tests/sdf/brute_force.h"

namespace glint {
namespace {

std::vector<Eigen::Vector3d> Points(size_t count, double size, const Eigen::Vector3d& center = {0, 0, 0}) {
  std::mt19937 random(3);
  std::vector<Eigen::Vector3d> points(count);
  for (Eigen::Vector3d& p : points)
    for (int k = 0; k < 3; ++k) p[k] = center[k] + size * (2.0 * random() / 4294967295.0 - 1);
  return points;
}

TEST(SignedDistance, PointsInDouble) {
  for (double scale : {1e-3, 1.0, 1e6}) {
    const Eigen::Vector3d offset = 1e4 * scale * Eigen::Vector3d(1, -0.7, 0.3);
    const TriangleMesh mesh = testing::Transformed(testing::SpikySphere(2, 0.6, 3), scale, offset);
    const auto points = Points(500, 2 * scale, offset);
    for (const char* sign : {"auto", "pseudonormal", "winding", "unsigned"}) {
      const std::vector<double> d = SignedDistance(mesh, points, sign);
      for (size_t i = 0; i < points.size(); ++i) {
        const double truth = testing::BruteDistance(mesh, points[i]);
        EXPECT_NEAR(std::abs(d[i]), truth, 1e-10 * scale);
        const bool inside = std::string(sign) != "unsigned" && testing::BruteInside(mesh, points[i]);
        EXPECT_EQ(d[i] < 0, inside) << sign;
      }
    }
  }
}

TEST(SignedDistance, AutoSaysWhatItDecided) {
  const TriangleMesh sphere = testing::Icosphere(3);
  SdfSummary summary;
  const auto decide = [&](const TriangleMesh& mesh) {
    SignedDistance(mesh, {{0, 0, 0}}, "auto", &summary);
    EXPECT_FALSE(summary.reason.empty());
    return summary.sign;
  };
  EXPECT_EQ(decide(sphere), "pseudonormal");
  EXPECT_FALSE(summary.turned);
  EXPECT_EQ(decide(testing::Inverted(sphere)), "pseudonormal");
  EXPECT_TRUE(summary.turned);
  TriangleMesh open = sphere;
  open.faces.resize(open.faces.size() - 5);
  EXPECT_EQ(decide(open), "winding");
  EXPECT_NE(summary.reason.find("boundary edges"), std::string::npos);
  EXPECT_EQ(decide(testing::Joined(sphere, testing::Transformed(sphere, 1, {0.7, 0, 0}))), "winding");  // overlap
  EXPECT_EQ(decide(testing::Joined(sphere, testing::Transformed(sphere, 0.3, {0, 0, 0}))), "winding");  // nested
  EXPECT_EQ(decide(testing::Joined(sphere, testing::Inverted(testing::Transformed(sphere, 0.3, {0, 0, 0})))),
            "pseudonormal");  // a cavity
  TriangleMesh doubled = sphere;
  doubled.faces.push_back(Eigen::Vector3i(sphere.faces[0][0], sphere.faces[0][0], sphere.faces[0][1]));
  EXPECT_EQ(decide(doubled), "pseudonormal");
  EXPECT_EQ(summary.degenerate_faces, 1u);
}

// The feature, its corner and the weights name the closest point on the face as it was given, turned or not.
void ExpectNames(const TriangleMesh& mesh, const Eigen::Vector3d& p, double distance, uint32_t face, Feature feature,
                 int corner, const Eigen::Vector3d& weights, double tolerance) {
  ASSERT_LT(face, mesh.faces.size());
  const Eigen::Vector3i& f = mesh.faces[face];
  const Eigen::Vector3d x =
      weights[0] * mesh.vertices[f[0]] + weights[1] * mesh.vertices[f[1]] + weights[2] * mesh.vertices[f[2]];
  EXPECT_NEAR((p - x).norm(), std::abs(distance), tolerance);
  if (feature == Feature::kVertex) {
    EXPECT_NEAR(weights[corner], 1, 1e-6);
  }
  if (feature == Feature::kEdge) {
    EXPECT_NEAR(weights[(corner + 2) % 3], 0, 1e-6);
  }
}

TEST(SignedDistance, ClosestFeatureOfThePoints) {
  TriangleMesh mesh = testing::SpikySphere(2, 0.6, 3);
  mesh.faces.insert(mesh.faces.begin() + 7, Eigen::Vector3i(1, 1, 2));  // left out: numbers shift
  for (const TriangleMesh& m : {mesh, testing::Inverted(mesh)}) {
    const SignedDistanceQuery query(m, "auto");
    for (const Eigen::Vector3d& p : Points(300, 1.5)) {
      const SignedDistanceQuery::Result at = query.FindClosest(p);
      EXPECT_EQ(at.distance, *query.Find(p));
      ExpectNames(m, p, at.distance, static_cast<uint32_t>(at.closest.face), at.closest.feature, at.closest.corner,
                  at.barycentric, 1e-9);
    }
  }
}

TEST(SignedDistance, ClosestFeatureOfEveryVoxel) {
  TriangleMesh mesh = testing::SpikySphere(2, 0.6, 3);
  mesh.faces.insert(mesh.faces.begin() + 7, Eigen::Vector3i(1, 1, 2));
  for (const TriangleMesh& m : {mesh, testing::Inverted(mesh)}) {
    std::vector<VoxelClosest> closest;
    const LevelSet level_set = MeshToLevelSet(m, 0.05, {}, nullptr, &closest);
    EXPECT_EQ(closest.size(), level_set.num_active_voxels());
    size_t features[3] = {0, 0, 0};
    for (const VoxelClosest& c : closest) {
      const openvdb::Coord at(c.voxel[0], c.voxel[1], c.voxel[2]);
      ASSERT_TRUE(level_set.impl().grid->tree().isValueOn(at));
      ++features[static_cast<int>(c.feature)];
      ExpectNames(m, 0.05 * c.voxel.cast<double>(), level_set.impl().grid->tree().getValue(at), c.face, c.feature,
                  c.corner, c.barycentric.cast<double>(), 1e-5);
    }
    for (size_t count : features) EXPECT_GT(count, 100u);
  }
}

TEST(SignedDistance, PointsInAPlaneAndInOnePlace) {
  const TriangleMesh mesh = testing::SpikySphere(2, 0.6, 3);
  auto points = Points(300, 2);
  for (size_t i = 0; i < points.size(); ++i) points[i][2] = 0.1;
  points.insert(points.end(), 5, points[7]);
  const std::vector<double> d = SignedDistance(mesh, points, "pseudonormal");
  for (size_t i = 0; i < points.size(); ++i)
    EXPECT_NEAR(std::abs(d[i]), testing::BruteDistance(mesh, points[i]), 1e-12);
}

TEST(SignedDistance, ReachIsKept) {
  const SignedDistanceQuery query(testing::Icosphere(3), "pseudonormal");
  EXPECT_FALSE(query.Find({3, 0, 0}, 1).has_value());
  EXPECT_TRUE(query.Find({1.5, 0, 0}, 1).has_value());
}

TEST(SignedDistance, SameAtAnyNumberOfThreads) {
  const TriangleMesh mesh = testing::SpikySphere(3, 0.5, 1);
  const auto points = Points(2000, 1.5);
  const ThreadLimit one(1);
  const auto a = SignedDistance(mesh, points);
  const ThreadLimit two(2);
  EXPECT_EQ(a, SignedDistance(mesh, points));
}

TEST(SignedDistance, BadInputIsRefused) {
  TriangleMesh box = testing::Box({0, 0, 0}, {1, 1, 1});
  EXPECT_THROW(SignedDistance(TriangleMesh(), {{0, 0, 0}}), InputError);
  EXPECT_THROW(SignedDistance(box, {{0, 0, 0}}, "magic"), InputError);
  box.vertices[2][0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(SignedDistance(box, {{0, 0, 0}}), InputError);
  EXPECT_TRUE(SignedDistance(testing::Icosphere(1), {}).empty());
  for (double bad : {std::numeric_limits<double>::quiet_NaN(), -std::numeric_limits<double>::infinity()}) {
    EXPECT_THROW(SignedDistance(testing::Icosphere(1), {{0, 0, 0}, {0, bad, 0}}), InputError);
    EXPECT_THROW(SignedDistanceQuery(testing::Icosphere(1), "auto").FindClosest({bad, 0, 0}), InputError);
  }
}

}  // namespace
}  // namespace glint
