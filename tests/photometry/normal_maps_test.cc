#include "photometry/normal_maps.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <random>

#include "tests/support/ellipsoid_scene.h"
#include "tests/support/shapes.h"

namespace glint {
namespace {

constexpr int kSize = 120;

// Maps of the unit sphere at half the photographs' size, their normals off by a few degrees; one shows nonsense.
class SphereMaps : public NormalSource {
 public:
  SphereMaps(const Scene& scene, double noise) : scene_(scene), noise_(noise) {}

  bool LoadNormals(size_t v, cv::Mat& normals) const override {
    if (v == 1) return false;
    const View& view = scene_.views[v];
    std::mt19937 random(static_cast<unsigned>(v));
    std::normal_distribution<double> error(0, noise_);
    normals = cv::Mat(kSize / 2, kSize / 2, CV_32FC3, cv::Scalar::all(0));
    const Eigen::Vector3d c = view.Center();
    const Eigen::Vector3d off(error(random), error(random), error(random));
    for (int y = 0; y < kSize / 2; ++y)
      for (int x = 0; x < kSize / 2; ++x) {
        const Eigen::Vector3d d = *view.RayThrough({2 * x + 1.0, 2 * y + 1.0});
        const double b = c.dot(d), inside = b * b - c.squaredNorm() + 1;
        if (inside < 0) continue;
        Eigen::Vector3d n = (c + (-b - std::sqrt(inside)) * d + off).normalized();
        if (v == 2) n = -d;
        const Eigen::Vector3f in_camera = (view.cam_from_world.rotation * n).cast<float>();
        normals.at<cv::Vec3f>(y, x) = {in_camera[0], in_camera[1], in_camera[2]};
      }
    return true;
  }

 private:
  const Scene& scene_;
  const double noise_;
};

// What the maps say is true within what they say of themselves, whatever the surface's own normals are.
TEST(NormalMaps, AgreeWithTheTruthWithinTheirScatter) {
  Scene scene;
  for (const Rigid3d& pose : testing::DomeViews(20)) {
    View& view = scene.views.emplace_back();
    view.camera = {1, CameraModel::kPinhole, kSize, kSize, {150, 150, kSize / 2.0, kSize / 2.0}};
    view.cam_from_world = pose;
  }
  TriangleMesh mesh = testing::Icosphere(4);
  mesh.normals = mesh.vertices;
  for (Eigen::Vector3d& n : mesh.normals) n = (n + Eigen::Vector3d(0.2, 0, 0)).normalized();
  const std::vector<SurfacePatch> patches = SpreadPatches(mesh, scene, 0.1);
  const GivenNormals given = TiltsFromNormalMaps(SphereMaps(scene, 0.03), scene, patches);
  EXPECT_GT(given.num_patches, patches.size() / 2);
  EXPECT_EQ(given.tilts.size(), 2 * given.num_patches);
  EXPECT_NEAR(given.scatter_deg, 0.03 * 180 / M_PI, 0.8);
  size_t within = 0;
  for (const Tilt& tilt : given.tilts) {
    EXPECT_NEAR(tilt.direction.norm(), 1, 1e-9);
    within += std::abs(tilt.cosine - tilt.direction.dot(tilt.position)) < 2 * tilt.sigma;
  }
  EXPECT_GT(static_cast<double>(within), 0.85 * static_cast<double>(given.tilts.size()));
}

}  // namespace
}  // namespace glint
