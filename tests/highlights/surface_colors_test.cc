#include "highlights/surface_colors.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "io/project_images.h"
#include "tests/support/ellipsoid_scene.h"
#include "tests/support/shapes.h"

namespace glint {
namespace {

using Rgb = std::array<uint8_t, 3>;
constexpr int kSize = 160;

// What the unit sphere is painted with.
Rgb Paint(const Eigen::Vector3d& x) {
  return {static_cast<uint8_t>(100 + 60 * x.x()), static_cast<uint8_t>(90 + 50 * x.y()),
          static_cast<uint8_t>(80 + 40 * x.z())};
}

// The painted sphere from a dome, with a white spot at the pixels where `spot` is.
struct PaintedSphere {
  Scene scene;
  std::vector<cv::Mat> images;
  std::vector<Highlight> spots;
  TriangleMesh mesh = testing::Icosphere(4);

  explicit PaintedSphere(const Eigen::Vector3d& spot) {
    mesh.normals = mesh.vertices;
    for (const Rigid3d& pose : testing::DomeViews(14)) {
      View& view = scene.views.emplace_back();
      view.camera = {1, CameraModel::kPinhole, kSize, kSize, {200, 200, kSize / 2.0, kSize / 2.0}};
      view.cam_from_world = pose;
      images.push_back(Render(view));
      if (spot.dot(view.Center().normalized()) < 0.5) continue;
      Highlight& h = spots.emplace_back();
      h.view = static_cast<uint32_t>(scene.views.size() - 1);
      h.px = *view.Project(spot);
      h.covariance_px = Eigen::Matrix2d::Identity();
      h.moments_px = 9 * Eigen::Matrix2d::Identity();
      cv::circle(images.back(), cv::Point2d(h.px.x() - 0.5, h.px.y() - 0.5), 6, cv::Scalar::all(255), cv::FILLED);
    }
  }

  static cv::Mat Render(const View& view) {
    cv::Mat image(kSize, kSize, CV_8UC3, cv::Scalar::all(0));
    const Eigen::Vector3d c = view.Center();
    for (int y = 0; y < kSize; ++y)
      for (int x = 0; x < kSize; ++x) {
        const Eigen::Vector3d d = *view.RayThrough({x + 0.5, y + 0.5});
        const double b = c.dot(d), inside = b * b - c.squaredNorm() + 1;
        if (inside < 0) continue;
        const Rgb rgb = Paint(c + (-b - std::sqrt(inside)) * d);
        image.at<cv::Vec3b>(y, x) = {rgb[2], rgb[1], rgb[0]};
      }
    return image;
  }

  SurfaceColors Colors(const std::vector<Highlight>& highlights) const {
    return ColorSurface(mesh, scene, MemoryImages(images), highlights, {}, Progress::Silent());
  }
};

int Difference(const Rgb& a, const Rgb& b) {
  int largest = 0;
  for (int c = 0; c < 3; ++c) largest = std::max(largest, std::abs(a[c] - b[c]));
  return largest;
}

const Eigen::Vector3d kTop = Eigen::Vector3d(0.2, 0.1, 1).normalized();

TEST(SurfaceColors, ArePaintWhereHighlightsAreKnown) {
  const PaintedSphere sphere(kTop);
  ASSERT_GT(sphere.spots.size(), 3u);
  // In every view that sees the place, but one, is a highlight: the median alone would be white.
  const std::vector<Highlight> all_but_one(sphere.spots.begin() + 1, sphere.spots.end());
  PaintedSphere clear_in_one = sphere;
  clear_in_one.images[sphere.spots[0].view] = PaintedSphere::Render(sphere.scene.views[sphere.spots[0].view]);
  const SurfaceColors colors = clear_in_one.Colors(all_but_one), blind = clear_in_one.Colors({});
  EXPECT_GT(colors.num_seen, sphere.mesh.vertices.size() / 2);
  int worst_blind = 0;
  for (size_t v = 0; v < sphere.mesh.vertices.size(); ++v) {
    const Eigen::Vector3d& x = sphere.mesh.vertices[v];
    if (x.z() < 0.3) continue;
    EXPECT_LE(Difference(colors.rgb[v], Paint(x)), 3) << x.transpose();
    worst_blind = std::max(worst_blind, Difference(blind.rgb[v], Paint(x)));
  }
  EXPECT_GT(worst_blind, 50) << "without the highlights the spot is in the colours";
}

}  // namespace
}  // namespace glint
