#include "pipeline/given_mesh.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "geometry/edge_topology.h"
#include "io/mesh_io.h"
#include "tests/support/shapes.h"

namespace glint {
namespace {

TEST(GivenMesh, AWideOpeningIsClosed) {
  TriangleMesh bowl = testing::Icosphere(3);
  std::erase_if(bowl.faces, [&](const Eigen::Vector3i& f) { return bowl.vertices[f[0]].z() > 0.7; });
  ASSERT_FALSE(EdgesBalanced(bowl));
  const std::filesystem::path file = std::filesystem::path(::testing::TempDir()) / "wide_open_bowl.ply";
  WriteMesh(file, bowl);
  Scene scene;
  View& view = scene.views.emplace_back();
  view.camera = {1, CameraModel::kPinhole, 100, 100, {100, 100, 50, 50}};
  view.cam_from_world.translation = {0, 0, 5};
  GivenMeshOptions options;
  options.closing_voxel_rel = 0.02;
  const GivenMesh given = ReadGivenMesh(file, scene, options);
  std::filesystem::remove(file);
  EXPECT_TRUE(EdgesBalanced(given.mesh));
  EXPECT_NEAR(BoundingBox(given.mesh).min().z(), -1, 0.05);
  EXPECT_LT(BoundingBox(given.mesh).max().z(), 0.95);
}

}  // namespace
}  // namespace glint
