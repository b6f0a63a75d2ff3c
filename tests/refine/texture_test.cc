// Photographs of a textured ball: what photo-consistency adds where there are neither points nor highlights.
#include <gtest/gtest.h>

#include <cmath>

#include "geometry/edge_topology.h"
#include "geometry/pseudo_normals.h"
#include "io/project_images.h"
#include "refine/refine.h"
#include "tests/stereo/textured_ball.h"
#include "tests/support/ball_mesh.h"

namespace glint {
namespace {

// Where cameras look at it.
double MeanRadiusError(const TriangleMesh& mesh) {
  double sum = 0, count = 0;
  for (const Eigen::Vector3d& x : mesh.vertices) {
    if (x.z() < 0.2) continue;
    sum += std::abs(x.norm() - 1);
    ++count;
  }
  return sum / count;
}

TEST(RefineByTexture, BringsWavesDownToTheSurface) {
  const Scene scene = testing::BallScene(30);
  TriangleMesh seed = testing::BallMesh({0, 0, 0}, 1, 40);
  for (Eigen::Vector3d& x : seed.vertices) x *= 1 + 0.01 * std::sin(6 * x.x() + 1) * std::cos(6 * x.y() + 2);
  RefineInput input{scene, seed, {}, {}, {}};
  RefineOptions options;
  options.voxel_rel = 1.0 / 64;
  options.levels = 2;
  options.max_iterations = 1;
  const MemoryImages images(testing::Photographs(scene, testing::Texture));
  input.images = &images;
  const auto error = [&](bool use) {
    options.photo.use = use;
    const RefineResult result = Refine(input, options);
    EXPECT_EQ(result.summary.num_photo_points > 100, use);
    return MeanRadiusError(result.mesh);
  };
  const double without = error(false);
  EXPECT_GT(without, 0.003);
  EXPECT_LT(error(true), 0.4 * without);
}

}  // namespace
}  // namespace glint
