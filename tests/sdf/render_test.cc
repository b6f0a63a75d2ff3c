#include "sdf/render.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/error.h"
#include "core/parallel.h"
#include "geometry/render_mesh.h"
#include "sdf/mesh_to_level_set.h"
#include "tests/geometry/test_meshes.h"

namespace glint {
namespace {

PictureView SmallView() {
  const Eigen::AlignedBox3d box(Eigen::Vector3d(-1, -1, -1), Eigen::Vector3d(1, 1, 1));
  return ViewOfBox(box, {0.3, -0.2, -1}, {0, 1, 0}, 120, 90);
}

size_t NumNotWhite(const std::vector<uint8_t>& pixels) {
  size_t count = 0;
  for (size_t i = 0; i < pixels.size(); i += 3) count += pixels[i] + pixels[i + 1] + pixels[i + 2] < 3 * 250;
  return count;
}

// The silhouette of a sphere of radius r at distance D is a cone of sine r / D.
double SilhouettePx(const PictureView& view, double radius) {
  const double sine = radius / view.CenterInWorld().norm();
  const double on_plane = view.focal_px * sine / std::sqrt(1 - sine * sine);
  return std::numbers::pi * on_plane * on_plane;
}

TEST(Render, SphereFillsItsSilhouette) {
  const PictureView view = SmallView();
  const TriangleMesh sphere = testing::Icosphere(4);
  EXPECT_NEAR(static_cast<double>(NumNotWhite(RenderMesh(sphere, view))), SilhouettePx(view, 1), 120);
  const LevelSet level_set = MeshToLevelSet(sphere, 0.05);
  EXPECT_NEAR(static_cast<double>(NumNotWhite(RenderLevelSet(level_set, view))), SilhouettePx(view, 1), 120);
  EXPECT_NEAR(static_cast<double>(NumNotWhite(RenderLevelSet(level_set, view, -0.1))), SilhouettePx(view, 0.9), 120);
}

TEST(Render, VolumeAndMeshLookAlike) {
  const PictureView view = SmallView();
  TriangleMesh mesh = testing::Icosphere(5);
  mesh.normals = mesh.vertices;
  MeshLook look;
  look.hidden_sky = false;
  const std::vector<uint8_t> of_mesh = RenderMesh(mesh, view, look);
  const std::vector<uint8_t> of_volume = RenderLevelSet(MeshToLevelSet(mesh, 0.04), view);
  size_t different = 0;
  for (size_t i = 0; i < of_mesh.size(); ++i) different += std::abs(of_mesh[i] - of_volume[i]) > 6;
  EXPECT_LT(different, of_mesh.size() / 50);
}

TEST(Render, VertexColorsShow) {
  const PictureView view = SmallView();
  TriangleMesh mesh = testing::Icosphere(2);
  mesh.colors.assign(mesh.vertices.size(), {255, 0, 0});
  const std::vector<uint8_t> pixels = RenderMesh(mesh, view);
  const size_t middle = 3 * (static_cast<size_t>(view.height / 2 * view.width) + static_cast<size_t>(view.width / 2));
  EXPECT_GT(pixels[middle], 3 * pixels[middle + 1]);
}

TEST(Render, SameAtAnyNumberOfThreads) {
  const LevelSet level_set = MeshToLevelSet(testing::SpikySphere(2, 0.3, 1), 0.05);
  const ThreadLimit limit(1);
  const std::vector<uint8_t> one = RenderLevelSet(level_set, SmallView());
  const ThreadLimit two(2);
  EXPECT_EQ(one, RenderLevelSet(level_set, SmallView()));
}

TEST(Render, EmptyAndBadInput) {
  EXPECT_EQ(NumNotWhite(RenderLevelSet(LevelSet(), SmallView())), 0u);
  EXPECT_EQ(NumNotWhite(RenderMesh(TriangleMesh(), SmallView())), 0u);
  const LevelSet level_set = MeshToLevelSet(testing::Icosphere(2), 0.1);
  EXPECT_THROW(RenderLevelSet(level_set, SmallView(), 0.31), InputError);
}

}  // namespace
}  // namespace glint
