#include "stereo/textured_places.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <opencv2/core.hpp>
#include <random>

#include "core/median.h"
#include "core/parallel.h"
#include "geometry/edge_topology.h"
#include "geometry/pseudo_normals.h"
#include "io/project_images.h"
#include "tests/seed/simulated_scene.h"
#include "tests/support/ball_mesh.h"

namespace glint {
namespace {

constexpr int kViews = 30;

// What a view sees of the unit ball.
using Look = std::function<Eigen::Vector3d(const Eigen::Vector3d& x, const Eigen::Vector3d& to_eye)>;

// Waves of a few pixels' length.
Eigen::Vector3d Texture(const Eigen::Vector3d& x, const Eigen::Vector3d&) {
  const double value = std::sin(71 * x.x() + 7 * std::sin(5 * x.y())) + std::sin(69 * x.y() + 31 * x.z()) +
                       std::sin(73 * x.z() - 37 * x.x());
  return Eigen::Vector3d(110, 120, 130) + 22 * value * Eigen::Vector3d(1, 0.8, 0.6);
}

Eigen::Vector3d Plain(const Eigen::Vector3d&, const Eigen::Vector3d&) { return {110, 120, 130}; }

class TexturedPlacesTest : public ::testing::Test {
 protected:
  TexturedPlacesTest() : scene_(DomeScene(kViews, 4)) {
    for (View& view : scene_.views) view.camera = {1, CameraModel::kPinhole, 320, 240, {360, 360, 160, 120}};
  }

  // On the surface of a ball of that radius.
  std::vector<TexturedPlace> Find(const Look& look, double radius, const std::vector<Light>& lights = {}) const {
    std::vector<cv::Mat> images(kViews);
    ParallelFor(kViews, 1, [&](size_t v) { images[v] = Photograph(v, look); });
    const SightColors colors(MemoryImages(images), 48, size_t{1} << 28, Progress::Silent());
    TriangleMesh surface = testing::BallMesh({0, 0, 0}, radius, 40);
    surface.normals = ComputePseudoNormals(surface, BuildEdgeTopology(surface)).vertex;
    return FindTexturedPlaces(scene_, colors, SpreadPatches(surface, scene_, 0.1), lights, 0.05);
  }

  cv::Mat Photograph(size_t v, const Look& look) const {
    const View& view = scene_.views[v];
    cv::Mat image(240, 320, CV_8UC3, cv::Scalar(90, 90, 90));
    const Eigen::Vector3d eye = view.Center();
    std::mt19937 random(static_cast<unsigned>(v));
    std::normal_distribution<double> noise(0, 1);
    for (int y = 0; y < image.rows; ++y)
      for (int x = 0; x < image.cols; ++x) {
        const Eigen::Vector3d direction = *view.RayThrough({x + 0.5, y + 0.5});
        const double along = -direction.dot(eye), across2 = eye.squaredNorm() - along * along;
        if (across2 >= 1) continue;
        const Eigen::Vector3d at = eye + (along - std::sqrt(1 - across2)) * direction;
        const Eigen::Vector3d color = look(at, -direction);
        for (int c = 0; c < 3; ++c) image.at<cv::Vec3b>(y, x)[c] = cv::saturate_cast<uint8_t>(color[c] + noise(random));
      }
    return image;
  }

  Scene scene_;
};

TEST_F(TexturedPlacesTest, ATexturedSurfaceIsFoundWhereItIs) {
  for (const double radius : {0.985, 1.0, 1.02}) {
    const std::vector<TexturedPlace> places = Find(Texture, radius);
    ASSERT_GT(places.size(), 60u) << radius;
    std::vector<double> off, in_sigmas;
    for (const TexturedPlace& p : places) {
      off.push_back(p.position.norm() - 1);
      in_sigmas.push_back(std::abs(off.back()) / p.sigma);
      EXPECT_GT(p.normal.dot(p.position), 0.95);
    }
    EXPECT_NEAR(Median(off), 0, 0.0015) << radius;  // a pixel is 0.009 wide
    std::sort(in_sigmas.begin(), in_sigmas.end());
    EXPECT_LT(in_sigmas[in_sigmas.size() * 9 / 10], 3) << radius;
  }
}

TEST_F(TexturedPlacesTest, OneColourShowsNothing) { EXPECT_TRUE(Find(Plain, 1.01).empty()); }

// A gloss of some degrees' width, mirroring a lamp: it moves with the eye, and lies behind the surface for any two.
TEST_F(TexturedPlacesTest, AHighlightIsNoTexture) {
  const Eigen::Vector3d to_light = Eigen::Vector3d(0.3, 0.2, 1).normalized();
  const Look glossy = [&](const Eigen::Vector3d& x, const Eigen::Vector3d& to_eye) -> Eigen::Vector3d {
    const double cosine = x.normalized().dot((to_light + to_eye).normalized());
    return Plain(x, to_eye) + Eigen::Vector3d::Constant(80 * std::exp((cosine - 1) / 0.002));
  };
  Light light;
  light.vector = to_light;
  EXPECT_TRUE(Find(glossy, 1.005, {light}).empty());
  for (const TexturedPlace& p : Find(glossy, 1.005)) EXPECT_GT(p.sigma, 0);  // unknown lights: few at the most
  EXPECT_LT(Find(glossy, 1.005).size(), 5u);
}

}  // namespace
}  // namespace glint
