#include "metrics/align.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/parallel.h"

namespace glint {
namespace {

// A body like a pear with a bump on one side: no turn takes it to itself.
TriangleMesh Pear(int rings = 10) {
  TriangleMesh mesh;
  const int segments = 2 * rings;
  for (int r = 0; r <= rings; ++r)
    for (int s = 0; s < segments; ++s) {
      const double theta = M_PI * r / rings, phi = 2 * M_PI * s / segments;
      const Eigen::Vector3d n(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta));
      const double radius =
          1 + 0.35 * n.z() + 0.2 * n.x() * n.x() + 0.15 * std::pow(std::max(0.0, n.y()), 3) + 0.1 * n.x() * n.y();
      mesh.vertices.push_back(radius * n);
    }
  for (int r = 0; r < rings; ++r)
    for (int s = 0; s < segments; ++s) {
      const int a = r * segments + s, b = r * segments + (s + 1) % segments;
      mesh.faces.emplace_back(a, a + segments, b + segments);
      mesh.faces.emplace_back(a, b + segments, b);
    }
  return mesh;
}

TriangleMesh Moved(TriangleMesh mesh, const Eigen::Affine3d& by) {
  for (Eigen::Vector3d& x : mesh.vertices) x = by * x;
  return mesh;
}

Eigen::Affine3d Somewhere(double scale) {
  Eigen::Affine3d a = Eigen::Affine3d::Identity();
  a.translate(Eigen::Vector3d(40, -7, 12));
  a.rotate(Eigen::AngleAxisd(2.2, Eigen::Vector3d(1, -2, 0.5).normalized()));
  a.scale(scale);
  return a;
}

double FarthestOff(const TriangleMesh& mesh, const Eigen::Affine3d& moved, const Eigen::Affine3d& back) {
  double farthest = 0;
  for (const Eigen::Vector3d& x : mesh.vertices) farthest = std::max(farthest, (back * (moved * x) - x).norm());
  return farthest;
}

TEST(Align, FindsTurnMoveAndScale) {
  const TriangleMesh pear = Pear();
  const Alignment found = AlignMeshes(Moved(pear, Somewhere(25)), pear, true);
  EXPECT_NEAR(found.scale, 1 / 25.0, 1e-6);
  EXPECT_LT(FarthestOff(pear, Somewhere(25), found.reference_from_mesh), 1e-4);
  EXPECT_LT(found.mean_rel, 1e-5);
  const ThreadLimit one(1);
  const Alignment again = AlignMeshes(Moved(pear, Somewhere(25)), pear, true);
  EXPECT_EQ(again.reference_from_mesh.matrix(), found.reference_from_mesh.matrix());
}

TEST(Align, KeepsTheSizeUnlessToldOtherwise) {
  const TriangleMesh pear = Pear();
  const Alignment found = AlignMeshes(Moved(pear, Somewhere(1.02)), pear, false);
  EXPECT_NEAR(found.scale, 1, 1e-9);
  EXPECT_NEAR(found.turned_deg, 2.2 * 180 / M_PI, 2);
  // Everywhere about a fiftieth of its radius outside, which is a third of its diagonal.
  EXPECT_NEAR(found.mean_rel, 0.02 / 3, 0.002);
}

TEST(Align, APartThatIsMissingDoesNotPull) {
  const TriangleMesh pear = Pear();
  TriangleMesh part = pear;
  std::erase_if(part.faces, [&](const Eigen::Vector3i& f) { return pear.vertices[f[0]].z() > 0.75; });
  EXPECT_LT(part.faces.size(), 0.85 * pear.faces.size());
  const Alignment found = AlignMeshes(Moved(part, Somewhere(3)), pear, true);
  EXPECT_LT(FarthestOff(pear, Somewhere(3), found.reference_from_mesh), 0.01);
}

TEST(Align, WhatIsSymmetricStaysAsItWas) {
  TriangleMesh ball = Pear();
  for (Eigen::Vector3d& x : ball.vertices) x.normalize();
  TriangleMesh aside = ball;
  for (Eigen::Vector3d& x : aside.vertices) x += Eigen::Vector3d(0.1, 0, 0);
  const Alignment found = AlignMeshes(aside, ball, true);
  EXPECT_LT(found.turned_deg, 0.5);
  EXPECT_LT((found.reference_from_mesh.translation() + Eigen::Vector3d(0.1, 0, 0)).norm(), 0.01);
}

}  // namespace
}  // namespace glint
