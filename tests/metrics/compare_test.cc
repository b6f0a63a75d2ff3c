#include "metrics/compare.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/parallel.h"

namespace glint {
namespace {

// A sphere of `radius` at `center` from a latitude-longitude grid, with exact normals.
TriangleMesh Sphere(double radius, const Eigen::Vector3d& center, int rings = 60) {
  TriangleMesh mesh;
  const int segments = 2 * rings;
  auto add = [&](double theta, double phi) {
    const Eigen::Vector3d n(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta));
    mesh.vertices.push_back(center + radius * n);
    mesh.normals.push_back(n);
    return static_cast<int>(mesh.vertices.size()) - 1;
  };
  const int top = add(0, 0);
  for (int r = 1; r < rings; ++r)
    for (int s = 0; s < segments; ++s) add(M_PI * r / rings, 2 * M_PI * s / segments);
  const int bottom = add(M_PI, 0);
  auto at = [&](int r, int s) { return 1 + (r - 1) * segments + s % segments; };
  for (int s = 0; s < segments; ++s) {
    mesh.faces.emplace_back(top, at(1, s), at(1, s + 1));
    for (int r = 1; r + 1 < rings; ++r) {
      mesh.faces.emplace_back(at(r, s), at(r + 1, s), at(r + 1, s + 1));
      mesh.faces.emplace_back(at(r, s), at(r + 1, s + 1), at(r, s + 1));
    }
    mesh.faces.emplace_back(at(rings - 1, s), bottom, at(rings - 1, s + 1));
  }
  return mesh;
}

TEST(Compare, AMeshWithItselfIsPerfect) {
  const TriangleMesh sphere = Sphere(2, {1, 2, 3});
  const MeshComparison c = CompareMeshes(sphere, sphere);
  EXPECT_LT(c.accuracy.max, 1e-12);
  EXPECT_LT(c.completeness.max, 1e-12);
  EXPECT_LT(c.normal_deg.max, 1e-3);
  for (const FScore& f : c.f_scores) EXPECT_EQ(f.f, 1);
}

TEST(Compare, ConcentricSpheresDifferByTheRadiiAndShareNormals) {
  const TriangleMesh inner = Sphere(1, Eigen::Vector3d::Zero()), outer = Sphere(1.1, Eigen::Vector3d::Zero());
  const MeshComparison c = CompareMeshes(inner, outer);
  EXPECT_NEAR(c.accuracy.mean, 0.1, 2e-3);
  EXPECT_NEAR(c.completeness.mean, 0.1, 2e-3);
  EXPECT_NEAR(c.accuracy_rel.mean, 0.1 / (2.2 * std::sqrt(3.0)), 1e-3);
  EXPECT_NEAR(c.chamfer, 0.1, 2e-3);
  EXPECT_LT(c.normal_deg.max, 0.1);
  EXPECT_EQ(c.f_scores[0].f, 0);
}

TEST(Compare, NormalsOfFacesStandInForThoseOfVertices) {
  TriangleMesh bare = Sphere(1, Eigen::Vector3d::Zero());
  const TriangleMesh reference = bare;
  bare.normals.clear();
  EXPECT_LT(CompareMeshes(bare, reference).normal_deg.max, 3);
  for (Eigen::Vector3i& f : bare.faces) std::swap(f[0], f[1]);
  EXPECT_GT(CompareMeshes(bare, reference).normal_deg.mean, 177);
}

TEST(Compare, IsTheSameAtAnyScaleAndPlace) {
  const MeshComparison a = CompareMeshes(Sphere(1, Eigen::Vector3d(0.05, 0, 0)), Sphere(1, Eigen::Vector3d::Zero()));
  for (double scale : {1e-6, 1e6}) {
    const Eigen::Vector3d at = scale * Eigen::Vector3d(3, -4, 5);
    const MeshComparison b = CompareMeshes(Sphere(scale, at + scale * Eigen::Vector3d(0.05, 0, 0)), Sphere(scale, at));
    EXPECT_NEAR(a.accuracy_rel.mean, b.accuracy_rel.mean, 1e-6);
    EXPECT_NEAR(a.completeness_rel.p95, b.completeness_rel.p95, 1e-6);
    EXPECT_NEAR(a.normal_deg.mean, b.normal_deg.mean, 1e-4);
  }
}

TEST(Compare, MaskRestrictsEveryFigure) {
  const TriangleMesh reference = Sphere(1, Eigen::Vector3d::Zero());
  TriangleMesh dented = reference;
  std::vector<uint8_t> upper(reference.vertices.size());
  for (size_t i = 0; i < upper.size(); ++i) {
    upper[i] = reference.vertices[i].z() > 0.2;
    if (reference.vertices[i].z() < 0) dented.vertices[i] *= 0.8;
  }
  const MeshComparison all = CompareMeshes(dented, reference);
  const MeshComparison masked = CompareMeshes(dented, reference, {}, upper);
  EXPECT_GT(all.accuracy.mean, 0.05);
  EXPECT_LT(masked.accuracy.mean, 1e-6);
  EXPECT_LT(masked.completeness.mean, 1e-6);
  EXPECT_LT(masked.normal_deg.mean, 0.1);
  EXPECT_EQ(NormalStats(all, upper).mean, masked.normal_deg.mean);
  EXPECT_LT(DistanceStatsRel(all, upper).max, 1e-6);
}

TEST(Compare, FacesWithoutAreaAreHarmless) {
  TriangleMesh mesh = Sphere(1, Eigen::Vector3d::Zero());
  mesh.faces.emplace_back(0, 0, 1);
  mesh.faces.emplace_back(5, 5, 5);
  const MeshComparison c = CompareMeshes(mesh, Sphere(1, Eigen::Vector3d::Zero()));
  EXPECT_LT(c.accuracy.max, 1e-12);
}

TEST(Compare, IsTheSameForAnyNumberOfThreads) {
  const TriangleMesh a = Sphere(1, Eigen::Vector3d(0.02, 0.01, 0), 30), b = Sphere(1.01, Eigen::Vector3d::Zero(), 40);
  MeshComparison one, two;
  {
    const ThreadLimit limit(1);
    one = CompareMeshes(a, b);
  }
  {
    const ThreadLimit limit(2);
    two = CompareMeshes(a, b);
  }
  EXPECT_EQ(one.accuracy.mean, two.accuracy.mean);
  EXPECT_EQ(one.reference_distance, two.reference_distance);
  EXPECT_EQ(one.reference_normal_deg, two.reference_normal_deg);
}

TEST(Compare, RejectsEmptyMeshes) {
  EXPECT_THROW(CompareMeshes(TriangleMesh(), Sphere(1, Eigen::Vector3d::Zero())), std::logic_error);
}

}  // namespace
}  // namespace glint
