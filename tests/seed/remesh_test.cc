#include "seed/remesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "geometry/closest_point.h"
#include "geometry/mesh_checks.h"
#include "io/mesh_io.h"
#include "tests/support/ball_mesh.h"

namespace glint {
namespace {

double MeanEdge(const TriangleMesh& mesh) {
  double sum = 0;
  for (const Eigen::Vector3i& f : mesh.faces)
    for (int k = 0; k < 3; ++k) sum += (mesh.vertices[f[k]] - mesh.vertices[f[(k + 1) % 3]]).norm();
  return sum / (3.0 * static_cast<double>(mesh.faces.size()));
}

TEST(Remesh, EvenEdgesOnTheSurface) {
  const TriangleMesh ball = testing::BallMesh({0, 0, 0}, 1, 30);
  const TriangleMesh even = RemeshEvenly(ball, 0.15);
  EXPECT_TRUE(CheckMeshSoundness(even).sound());
  EXPECT_NEAR(MeanEdge(even), 0.15, 0.02);
  const ClosestPointQuery query(ball);
  for (const Eigen::Vector3d& v : even.vertices) EXPECT_LT(query.Find(v)->squared_distance, 1e-20);
  // Of nearly equilateral triangles: their area is what their edges say.
  const double equilateral = std::sqrt(3) / 4 * MeanEdge(even) * MeanEdge(even);
  EXPECT_NEAR(SurfaceArea(even) / static_cast<double>(even.faces.size()), equilateral, 0.05 * equilateral);
}

// In the middle of it CGAL makes vertices around which all faces are without area.
TEST(Remesh, ThinSheetsOfFarApartPoints) {
  const TriangleMesh bowl = ReadMesh(std::filesystem::path(GLINT_SOURCE_DIR) / "tests/seed/meshes/thin_bowl.ply");
  const TriangleMesh even = RemeshEvenly(bowl, 0.015 * Diagonal(bowl));
  const MeshChecks checks = CheckMeshSoundness(even, {.self_intersections = false});
  EXPECT_TRUE(checks.closed && checks.oriented && checks.manifold);
}

}  // namespace
}  // namespace glint
