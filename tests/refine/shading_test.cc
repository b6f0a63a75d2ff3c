// Rendered photographs: what shading adds where no highlight says anything.
#include <gtest/gtest.h>

#include <cmath>

#include "metrics/compare.h"
#include "metrics/swept_region.h"
#include "refine/refine.h"
#include "synthetic/synthetic_image_source.h"

namespace glint {
namespace {

SyntheticOptions SmallScene() {
  SyntheticOptions options;
  options.scene = "ellipsoid";
  options.views = 8;
  options.width = 320;
  options.height = 240;
  options.lights = 2;
  return options;
}

// The true surface with waves of four degrees.
TriangleMesh Wavy(TriangleMesh seed) {
  const double diagonal = Diagonal(seed);
  for (size_t v = 0; v < seed.vertices.size(); ++v) {
    const Eigen::Vector3d x = seed.vertices[v] * (2 * M_PI * 4 / diagonal);
    seed.vertices[v] += 0.003 * diagonal * std::sin(x.x() + 1) * std::cos(x.y() + 2) * seed.normals[v];
  }
  seed.normals.clear();
  return seed;
}

TEST(RefineByShading, FlattensWavesThatNoHighlightTouches) {
  const SyntheticScene scene = SynthesizeScene(SmallScene());
  const SyntheticImageSource images(scene);
  const TriangleMesh truth = TrueMesh(scene, 60), seed = Wavy(truth);
  const Scene views = MakeScene(scene.model);
  RefineInput input{views, seed, {}, {}, scene.lights};
  input.images = &images;
  RefineOptions options;
  options.voxel_rel = 1.0 / 64;
  options.levels = 1;
  options.max_iterations = 2;
  const std::vector<uint16_t> seen = VisibleViews(truth, views);
  std::vector<uint8_t> lit(truth.vertices.size());
  for (size_t v = 0; v < lit.size(); ++v) lit[v] = seen[v] > 0 && truth.normals[v].dot(scene.lights[0].vector) > 0.2;
  const auto error_deg = [&](bool use_shading) {
    options.tilts.use_shading = use_shading;
    const RefineResult result = Refine(input, options);
    EXPECT_EQ(result.summary.tilts.num_shaded > 500, use_shading);
    EXPECT_EQ(result.summary.tilts.materials.empty(), !use_shading);
    return NormalStats(CompareMeshes(result.mesh, truth), lit).mean;
  };
  const double with = error_deg(true), without = error_deg(false);
  EXPECT_LT(with, 0.9 * without);
}

}  // namespace
}  // namespace glint
