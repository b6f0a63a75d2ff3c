#include "highlights/ball_image.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <filesystem>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "io/project_images.h"

namespace glint {
namespace {

constexpr int kWidth = 640, kHeight = 480;

double AngleDeg(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) * 180 / M_PI;
}

Camera TestCamera() {
  Camera camera;
  camera.model = CameraModel::kSimplePinhole;
  camera.width = kWidth, camera.height = kHeight;
  camera.params = {700, kWidth / 2, kHeight / 2};
  return camera;
}

uint8_t Encoded(double linear) {
  const double c = std::clamp(linear, 0.0, 1.0);
  return cv::saturate_cast<uint8_t>(255 * (c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055));
}

// A ball before a gray wall; chrome with a lamp of `lamp_deg` across, or diffuse.
cv::Mat Photograph(const Ball& ball, const Eigen::Vector3d& light, BallKind kind, double lamp_deg = 4) {
  const Camera camera = TestCamera();
  cv::Mat image(kHeight, kWidth, CV_8UC3, cv::Scalar::all(Encoded(0.2)));
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const Eigen::Vector2d px(x + 0.5, y + 0.5);
      const auto normal = BallNormal(camera, ball, px);
      if (!normal) continue;
      double value = 0.02 + 0.6 * std::max(0.0, normal->dot(light));
      if (kind == BallKind::kChrome) {
        const double off = AngleDeg(*MirroredDirection(camera, ball, px), light);
        value = off < lamp_deg / 2 ? 1 : off < 40 ? 0.06 : 0.03;
      }
      image.at<cv::Vec3b>(y, x) = cv::Vec3b::all(Encoded(value));
    }
  cv::GaussianBlur(image, image, {}, 0.6);
  return image;
}

class BallImage : public ::testing::TestWithParam<BallKind> {};

TEST_P(BallImage, GivesTheLightFromTheCircleItFinds) {
  const Camera camera = TestCamera();
  for (const Ball& ball : {Ball{{0, 0, 5}}, Ball{{0.9, -0.5, 5}}})
    for (const Eigen::Vector3d& l : {Eigen::Vector3d(0.3, -0.6, -0.8), Eigen::Vector3d(-0.7, -0.2, -0.6)}) {
      const cv::Mat image = Photograph(ball, l.normalized(), GetParam());
      const auto circle = FindBallCircle(image);
      ASSERT_TRUE(circle);
      EXPECT_EQ(GuessBallKind(image, *circle), GetParam());
      const auto found = BallFromCircle(camera, circle->center_px, circle->radius_px);
      ASSERT_TRUE(found);
      const BallLightResult result = LightOfBall(image, camera, *found, *circle, GetParam());
      ASSERT_TRUE(result.light) << result.why;
      EXPECT_LT(AngleDeg(result.light->direction, l), 2);
      if (GetParam() == BallKind::kChrome) {
        EXPECT_NEAR(result.light->angular_size_deg, 4, 2.5);
      }
    }
}

INSTANTIATE_TEST_SUITE_P(Kinds, BallImage, ::testing::Values(BallKind::kChrome, BallKind::kGray),
                         [](const auto& kind) { return kind.param == BallKind::kChrome ? "Chrome" : "Gray"; });

TEST(BallImage, NoBallAndNoLamp) {
  EXPECT_FALSE(FindBallCircle(cv::Mat(kHeight, kWidth, CV_8UC3, cv::Scalar::all(90))));
  EXPECT_FALSE(CircleOfMask(cv::Mat::zeros(100, 100, CV_8U)));
  const Ball ball{{0, 0, 5}};
  const cv::Mat black = cv::Mat::zeros(kHeight, kWidth, CV_8UC3);
  const BallCircle circle{{kWidth / 2, kHeight / 2}, 140};
  for (const BallKind kind : {BallKind::kChrome, BallKind::kGray}) {
    const BallLightResult result = LightOfBall(black, TestCamera(), ball, circle, kind);
    EXPECT_FALSE(result.light);
    EXPECT_FALSE(result.why.empty());
  }
}

TEST(BallImage, TheCircleOfAMask) {
  cv::Mat mask = cv::Mat::zeros(200, 300, CV_8U);
  cv::circle(mask, {120, 90}, 50, 255, cv::FILLED);
  const auto circle = CircleOfMask(mask);
  ASSERT_TRUE(circle);
  EXPECT_LT((circle->center_px - Eigen::Vector2d(120.5, 90.5)).norm(), 0.2);
  EXPECT_NEAR(circle->radius_px, 50, 1);
}

}  // namespace
}  // namespace glint
