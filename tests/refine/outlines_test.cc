// What the object's outlines add to the refinement.
#include <gtest/gtest.h>

#include <cmath>

#include "refine/refine.h"
#include "tests/seed/simulated_scene.h"
#include "tests/support/ball_mesh.h"

namespace glint {
namespace {

// Of a unit ball at the origin, exact: from each view, `count` rays that touch it.
std::vector<OutlineSample> BallOutline(const Scene& scene, int count) {
  std::vector<OutlineSample> outline;
  for (size_t v = 0; v < scene.views.size(); ++v) {
    const Eigen::Vector3d eye = scene.views[v].Center(), axis = eye.normalized();
    const Eigen::Vector3d side = axis.unitOrthogonal(), up = axis.cross(side);
    const double cosine = 1 / eye.norm(), sine = std::sqrt(1 - cosine * cosine);
    for (int k = 0; k < count; ++k) {
      const double angle = 2 * M_PI * k / count;
      OutlineSample s;
      s.view = static_cast<uint32_t>(v);
      s.normal = cosine * axis + sine * (std::cos(angle) * side + std::sin(angle) * up);
      s.ray = (s.normal - eye).normalized();
      s.depth = (s.normal - eye).norm();
      s.near = s.depth - 0.4;
      s.far = s.depth + 0.4;
      s.sigma = 0.004;
      s.px = Eigen::Vector2d::Zero();  // not looked at
      outline.push_back(s);
    }
  }
  return outline;
}

// A ball of points with a dent that only outlines show.
class RefineWithOutlines : public ::testing::Test {
 protected:
  RefineResult Of(double dent, bool use_outlines) {
    TriangleMesh seed = testing::BallMesh({0, 0, 0}, 1, 40);
    for (Eigen::Vector3d& x : seed.vertices) x *= 1 - dent * std::exp(-(x - Eigen::Vector3d::UnitX()).squaredNorm());
    RefineInput input{scene_, seed, {}, {}, {}};
    input.outline = BallOutline(scene_, 40);
    RefineOptions options;
    options.voxel_rel = 1.0 / 64;
    options.levels = 1;
    options.use_outlines = use_outlines;
    return Refine(input, options);
  }

  static double WorstRadiusError(const TriangleMesh& mesh) {
    double worst = 0;
    for (const Eigen::Vector3d& x : mesh.vertices) worst = std::max(worst, std::abs(x.norm() - 1));
    return worst;
  }

  const Scene scene_ = DomeScene(40, 4);
};

TEST_F(RefineWithOutlines, TheDentComesOut) {
  const RefineResult without = Of(0.1, false), with = Of(0.1, true);
  EXPECT_GT(WorstRadiusError(without.mesh), 0.08);
  EXPECT_LT(WorstRadiusError(with.mesh), 0.5 * WorstRadiusError(without.mesh));
}

// To a twentieth of a voxel.
TEST_F(RefineWithOutlines, WhatFitsThemStays) { EXPECT_LT(WorstRadiusError(Of(0, true).mesh), 0.0027); }

}  // namespace
}  // namespace glint
