#include "geometry/simplify.h"

#include <gmock/gmock.h>

#include "tests/support/shapes.h"

namespace glint {
namespace {

TEST(Simplify, KeepsASphereASphere) {
  const TriangleMesh sphere = testing::Icosphere(5);
  const TriangleMesh simple = Simplify(sphere, 2000);
  EXPECT_LE(simple.faces.size(), 2000);
  EXPECT_GE(simple.faces.size(), 1900);
  EXPECT_NEAR(SignedVolume(simple), SignedVolume(sphere), 0.01);
  for (const Eigen::Vector3d& v : simple.vertices) EXPECT_NEAR(v.norm(), 1, 0.01);
}

TEST(Simplify, ASmallMeshIsLeftAlone) {
  const TriangleMesh sphere = testing::Icosphere(2);
  const TriangleMesh same = Simplify(sphere, 1000);
  EXPECT_EQ(same.vertices.size(), sphere.vertices.size());
  EXPECT_EQ(same.faces.size(), sphere.faces.size());
  EXPECT_NEAR(SignedVolume(same), SignedVolume(sphere), 1e-12);
}

TEST(Simplify, FacesThatFitNowhereStay) {
  TriangleMesh mesh;  // three faces on one edge
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}};
  mesh.faces = {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}};
  const TriangleMesh out = Simplify(mesh, 100);
  EXPECT_EQ(out.faces.size(), 3);
  EXPECT_NEAR(SurfaceArea(out), SurfaceArea(mesh), 1e-12);
}

TEST(Simplify, TheSameEveryTime) {
  const TriangleMesh sphere = testing::Icosphere(4);
  const TriangleMesh a = Simplify(sphere, 500), b = Simplify(sphere, 500);
  EXPECT_EQ(a.vertices, b.vertices);
}

}  // namespace
}  // namespace glint
