#include "seed/outline_rim.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>

#include "core/parallel.h"
#include "geometry/mesh_checks.h"
#include "io/project_images.h"
#include "sdf/csg.h"
#include "seed/shape.h"
#include "tests/seed/simulated_scene.h"
#include "tests/support/ball_mesh.h"

namespace glint {
namespace {

constexpr int kViews = 24;
constexpr double kFlangeHeight = 0.3, kHalfThickness = 0.04;

// A unit ball with a flange around it, and what cameras on a dome see of it.
class MissingRimTest : public ::testing::Test {
 protected:
  MissingRimTest() : scene_(DomeScene(kViews, 5)) {
    for (View& view : scene_.views) view.camera = {1, CameraModel::kPinhole, 280, 210, {315, 315, 140, 105}};
  }

  Silhouettes Seen(double flange_radius) const {
    std::vector<cv::Mat> images(kViews), masks(kViews);
    ParallelFor(kViews, 1, [&](size_t v) {
      images[v] = cv::Mat(210, 280, CV_8UC3, cv::Scalar(80, 80, 80));
      masks[v] = cv::Mat(210, 280, CV_8UC1, cv::Scalar(0));
      for (int y = 0; y < 210; ++y)
        for (int x = 0; x < 280; ++x)
          if (Meets(scene_.views[v].Center(), *scene_.views[v].RayThrough({x + 0.5, y + 0.5}), flange_radius))
            masks[v].at<uint8_t>(y, x) = 255;
    });
    const MemoryImages source(images, masks);
    Silhouettes silhouettes = FindSilhouettes(scene_, source, {ball_, {}});
    EXPECT_GT(silhouettes.outline().size(), 700u);
    return silhouettes;
  }
  TriangleMesh Find(const Silhouettes& silhouettes) const {
    return MissingRim(scene_, silhouettes, ball_, 0.02 * Diagonal(ball_), 0.015);
  }

  // In steps that the flange's thickness does not slip through.
  static bool Meets(const Eigen::Vector3d& eye, const Eigen::Vector3d& direction, double flange_radius) {
    for (double t = 3.5; t < 6.5; t += 0.02) {
      const Eigen::Vector3d x = eye + t * direction;
      if (x.norm() < 1) return true;
      if (std::abs(x.z() - kFlangeHeight) < kHalfThickness && std::hypot(x.x(), x.y()) < flange_radius) return true;
    }
    return false;
  }

  Scene scene_;
  const TriangleMesh ball_ = testing::BallMesh({0, 0, 0}, 1, 40);
};

TEST_F(MissingRimTest, WhatTheOutlinesShowIsAdded) {
  constexpr double kFlangeRadius = 1.1;
  const Silhouettes silhouettes = Seen(kFlangeRadius);
  const TriangleMesh rim = Find(silhouettes);
  ASSERT_FALSE(rim.empty());
  const TriangleMesh whole = Union(ball_, rim, 0.015);
  // The flange's edge is reached all around, and nothing stands out of the object above it (below it
  // no camera sees).
  std::vector<double> reached(36, 0);
  for (const Eigen::Vector3d& x : whole.vertices) {
    const double radius = std::hypot(x.x(), x.y());
    const int sector = static_cast<int>((std::atan2(x.y(), x.x()) + M_PI) / (2 * M_PI) * 35.999);
    reached[sector] = std::max(reached[sector], radius);
    if (x.z() > kFlangeHeight + kHalfThickness + 0.2) {
      EXPECT_LT(x.norm(), 1.05) << x.transpose();
    }
  }
  for (const double radius : reached) EXPECT_NEAR(radius, kFlangeRadius, 0.025);

  const TriangleMesh joined = WithRim(scene_, silhouettes, ball_, 0.015);
  EXPECT_TRUE(CheckMeshSoundness(joined).sound());
  EXPECT_EQ(GenusOf(joined), 0);
  EXPECT_GT(BoundingBox(joined).sizes().x(), 2 * kFlangeRadius - 0.1);
}

TEST_F(MissingRimTest, NothingIsAddedToWhatFits) {
  const Silhouettes silhouettes = Seen(0);
  EXPECT_TRUE(Find(silhouettes).empty());
  EXPECT_EQ(WithRim(scene_, silhouettes, ball_, 0.015).vertices.size(), ball_.vertices.size());
}

}  // namespace
}  // namespace glint
