#include "sdf/extract_mesh.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"
#include "core/parallel.h"
#include "geometry/mesh_checks.h"
#include "sdf/mesh_to_level_set.h"
#include "sdf/rebuild.h"
#include "tests/geometry/test_meshes.h"

namespace glint {
namespace {

TEST(ExtractMesh, SphereKeepsItsRadius) {
  const TriangleMesh sphere = testing::Icosphere(5);
  const LevelSet level_set = MeshToLevelSet(sphere, 0.05);
  const TriangleMesh mesh = ExtractMesh(level_set);
  ASSERT_FALSE(mesh.empty());
  EXPECT_GT(SignedVolume(mesh), 0);
  double low = 2, high = 0, mean = 0;
  for (size_t v = 0; v < mesh.vertices.size(); ++v) {
    const double r = mesh.vertices[v].norm();
    low = std::min(low, r), high = std::max(high, r), mean += r / static_cast<double>(mesh.vertices.size());
    EXPECT_GT(mesh.normals[v].dot(mesh.vertices[v].normalized()), 0.99);
  }
  EXPECT_NEAR(mean, 1, 0.0015);
  EXPECT_GT(low, 0.997);
  EXPECT_LT(high, 1.001);
}

TEST(Redistance, KeepsTheZeroSet) {
  const TriangleMesh sphere = testing::Icosphere(5);
  const LevelSet level_set = Redistance(MeshToLevelSet(sphere, 0.05), 4);
  EXPECT_NEAR(level_set.half_width_voxels(), 4, 1e-5);
  EXPECT_NEAR(level_set.Value({1.0, 0, 0}), 0, 0.05 * 0.03);
  EXPECT_NEAR(level_set.Value({0.9, 0, 0}), -0.1, 0.05 * 0.05);
}

}  // namespace
}  // namespace glint
