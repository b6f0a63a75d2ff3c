#include "geometry/curvature.h"

#include <gmock/gmock.h>

#include "tests/support/shapes.h"

namespace glint {
namespace {

TEST(MeanCurvature, OfASphereIsOneOverItsRadius) {
  TriangleMesh sphere = testing::Icosphere(4);
  sphere.normals = sphere.vertices;
  for (Eigen::Vector3d& v : sphere.vertices) v *= 2.5;
  for (double c : MeanCurvature(sphere)) EXPECT_NEAR(c, 1 / 2.5, 0.004);
  for (Eigen::Vector3d& n : sphere.normals) n = -n;  // seen from within it is hollow
  for (double c : MeanCurvature(sphere)) EXPECT_NEAR(c, -1 / 2.5, 0.004);
}

TEST(MeanCurvature, OfAPlaneAndWithoutAreaIsZero) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {3, 3, 3}, {3, 3, 3}, {4, 4, 4}};
  mesh.faces = {{0, 1, 2}, {3, 4, 5}};
  mesh.normals.assign(6, Eigen::Vector3d::UnitZ());
  for (double c : MeanCurvature(mesh)) EXPECT_EQ(c, 0);
}

}  // namespace
}  // namespace glint
