#include "synthetic/true_highlights.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>

#include "synthetic/synthesize.h"

namespace glint {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// The reflection point of a distant light on the unit sphere at the origin, from the law of reflection alone: in the
// plane of camera and light, the normal's angle to the light equals its angle to the camera.
Vector3d ReflectionOnUnitSphere(const Vector3d& camera, const Vector3d& to_light) {
  const Vector3d across = (to_light - to_light.dot(camera.normalized()) * camera.normalized()).normalized();
  const double light_angle = std::acos(to_light.dot(camera.normalized()));
  const auto normal = [&](double angle) {
    return Vector3d(std::cos(angle) * camera.normalized() + std::sin(angle) * across);
  };
  double low = 0, high = light_angle;
  for (int i = 0; i < 100; ++i) {
    const double angle = 0.5 * (low + high);
    const Vector3d n = normal(angle);
    const double to_camera = std::acos(n.dot((camera - n).normalized()));
    (to_camera < light_angle - angle ? low : high) = angle;
  }
  return normal(low);
}

// Peak of a smooth bump by a parabola through the logarithms of the 3 by 3 pixels around the largest.
Vector2d PeakOf(const ViewTruth& truth) {
  const auto at = [&](int x, int y) {
    return std::log(double{truth.specular[static_cast<size_t>(y) * truth.width + x]});
  };
  int best_x = 1, best_y = 1;
  for (int y = 1; y + 1 < truth.height; ++y)
    for (int x = 1; x + 1 < truth.width; ++x)
      if (at(x, y) > at(best_x, best_y)) best_x = x, best_y = y;
  const auto vertex = [](double before, double here, double after) {
    return 0.5 * (before - after) / (before - 2 * here + after);
  };
  return {best_x + 0.5 + vertex(at(best_x - 1, best_y), at(best_x, best_y), at(best_x + 1, best_y)),
          best_y + 0.5 + vertex(at(best_x, best_y - 1), at(best_x, best_y), at(best_x, best_y + 1))};
}

TEST(TrueHighlights, SphereMatchesTheReflectionFormulaAndTheRendering) {
  SyntheticOptions options;
  options.scene = "sphere";
  options.views = 6;
  options.width = 400;
  options.height = 300;
  options.place = false;
  const SyntheticScene scene = SynthesizeScene(options);
  for (size_t v = 0; v < 6; ++v) {
    const Rigid3d& cam_from_world = scene.model.images[v].cam_from_world;
    const Vector3d contact = ReflectionOnUnitSphere(cam_from_world.Inverse().translation, scene.lights[0].vector);
    const Vector2d expected = *ProjectToPixel(scene.model.cameras.at(1), cam_from_world * contact);
    cv::Mat image;
    ViewTruth truth;
    RenderView(scene, v, image, truth);
    ASSERT_EQ(truth.highlights.size(), 1u);
    const TrueHighlight& h = truth.highlights[0];
    EXPECT_LT((h.px - expected).norm(), 1e-5);
    EXPECT_LT((h.position - contact).norm(), 1e-7);
    EXPECT_TRUE(h.lit);
    EXPECT_LT((PeakOf(truth) - expected).norm(), 0.5);
    // And there the photograph is saturated.
    const cv::Vec3b pixel = image.at<cv::Vec3b>(static_cast<int>(expected.y()), static_cast<int>(expected.x()));
    EXPECT_GT(pixel[1], 250);
    EXPECT_GT(h.strength, 1);
  }
}

// Largest of the three by three pixels around.
double SpecularAround(const ViewTruth& truth, const Vector2d& px) {
  double most = 0;
  for (int y = static_cast<int>(px.y()) - 1; y <= static_cast<int>(px.y()) + 1; ++y)
    for (int x = static_cast<int>(px.x()) - 1; x <= static_cast<int>(px.x()) + 1; ++x)
      if (x >= 0 && y >= 0 && x < truth.width && y < truth.height)
        most = std::max<double>(most, truth.specular[static_cast<size_t>(y) * truth.width + x]);
  return most;
}

class EveryLight : public testing::TestWithParam<std::tuple<const char*, const char*, const char*>> {};

TEST_P(EveryLight, NormalIsTheHalfVectorAtTheContact) {
  const auto [shape, light_kind, camera_model] = GetParam();
  SyntheticOptions options;
  options.scene = shape;
  options.light_kind = light_kind;
  options.camera_model = camera_model;
  options.lights = 2;
  options.views = 6;
  options.width = 320;
  options.height = 240;
  options.scale = 0.01;
  const SyntheticScene scene = SynthesizeScene(options);
  const LightFrame frame =
      options.light_kind == "flash" || options.light_kind == "camera" ? LightFrame::kCamera : LightFrame::kWorld;
  int found = 0, lit = 0, shown = 0;
  for (size_t v = 0; v < 6; ++v) {
    const Rigid3d& cam_from_world = scene.model.images[v].cam_from_world;
    const Vector3d center = cam_from_world.Inverse().translation;
    cv::Mat image;
    ViewTruth truth;
    RenderView(scene, v, image, truth);
    for (const TrueHighlight& h : truth.highlights) {
      ++found;
      ASSERT_EQ(scene.lights[h.light].frame, frame);
      EXPECT_LT((HalfVector(scene.lights[h.light], cam_from_world, h.position) - h.normal).norm(), 1e-6);
      EXPECT_LT(std::abs(scene.shape->Value(h.position)), 1e-9 * options.scale);
      EXPECT_LT((scene.shape->Normal(h.position) - h.normal).norm(), 1e-9);
      EXPECT_LT((*ProjectToPixel(scene.model.cameras.at(1), cam_from_world * h.position) - h.px).norm(), 1e-5);
      // Visible: nothing of the object before it.
      const Vector3d direction = (h.position - center).normalized();
      const auto hit = TraceRay(*scene.shape, center, direction, 0, 1e9);
      ASSERT_TRUE(hit);
      EXPECT_LT((hit->position - h.position).norm(), 1e-5 * options.scale);
      const double specular = SpecularAround(truth, h.px);
      lit += h.lit;
      shown += h.lit && specular > 0.3 * h.strength;
    }
  }
  EXPECT_GE(found, 6);
  EXPECT_GE(shown, 0.75 * lit);  // those on sharply curved places are smaller than a pixel
}

INSTANTIATE_TEST_SUITE_P(Kinds, EveryLight,
                         testing::Values(std::tuple("torus", "distant", "PINHOLE"),
                                         std::tuple("blob", "point", "OPENCV"),
                                         std::tuple("hood", "flash", "SIMPLE_RADIAL"),
                                         std::tuple("touching", "camera", "PINHOLE"),
                                         std::tuple("pane", "distant", "PINHOLE")));

}  // namespace
}  // namespace glint
