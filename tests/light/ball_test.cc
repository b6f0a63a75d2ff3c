#include "light/ball.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

namespace glint {
namespace {

double AngleDeg(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) * 180 / M_PI;
}

Camera WideCamera() {
  Camera camera;
  camera.model = CameraModel::kSimplePinhole;
  camera.width = 800, camera.height = 600;
  camera.params = {700, 400, 300};
  return camera;
}

// The outline of a ball as it really is: rays that touch it.
std::vector<Eigen::Vector2d> TrueOutline(const Camera& camera, const Ball& ball) {
  const double distance = ball.center.norm(), sin_alpha = 1 / distance;
  const Eigen::Vector3d axis = ball.center / distance, e1 = axis.unitOrthogonal(), e2 = axis.cross(e1);
  std::vector<Eigen::Vector2d> outline;
  for (int k = 0; k < 60; ++k) {
    const double a = 2 * M_PI * k / 60;
    const Eigen::Vector3d ray =
        std::sqrt(1 - sin_alpha * sin_alpha) * axis + sin_alpha * (std::cos(a) * e1 + std::sin(a) * e2);
    outline.push_back(*ProjectToPixel(camera, ray));
  }
  return outline;
}

// Where a mirror ball shows a distant light: the point whose normal halves the angle, by bisection of a fixed point.
Eigen::Vector2d MirrorPixel(const Camera& camera, const Ball& ball, const Eigen::Vector3d& light) {
  Eigen::Vector3d x = ball.center - ball.center.normalized();
  for (int i = 0; i < 200; ++i) x = ball.center + (light - x.normalized()).normalized();
  return *ProjectToPixel(camera, x);
}

TEST(Ball, IsFoundFromItsPerspectiveOutline) {
  const Camera camera = WideCamera();
  for (const Ball& truth : {Ball{{0, 0, 8}}, Ball{{3, -1.5, 7}}, Ball{{-4, 2.5, 9}}}) {
    auto outline = TrueOutline(camera, truth);
    const auto ball = BallFromOutline(camera, outline);
    ASSERT_TRUE(ball);
    EXPECT_LT((ball->center - truth.center).norm(), 1e-6);
    // Stray edges do not count.
    for (size_t k = 0; k < 8; ++k) outline[5 * k] += Eigen::Vector2d(25, -13);
    EXPECT_LT(AngleDeg(BallFromOutline(camera, outline)->center, truth.center), 0.1);
  }
}

TEST(Ball, MirrorsALightInPerspective) {
  const Camera camera = WideCamera();
  const Ball ball{{3, -1.5, 7}};
  for (const Eigen::Vector3d& l :
       {Eigen::Vector3d(0, -1, -1), Eigen::Vector3d(1, 0, -0.2), Eigen::Vector3d(-1, -1, -2)}) {
    const auto direction = MirroredDirection(camera, ball, MirrorPixel(camera, ball, l.normalized()));
    ASSERT_TRUE(direction);
    EXPECT_LT(AngleDeg(*direction, l), 1e-6);
  }
  EXPECT_FALSE(MirroredDirection(camera, ball, {10, 590}));
}

TEST(Ball, ACircleIsAboutItsOutlineNearTheMiddle) {
  const Camera camera = WideCamera();
  const Ball truth{{0, 0, 8}};
  const double radius = 700 / std::sqrt(63.0);
  const auto ball = BallFromCircle(camera, {400, 300}, radius);
  ASSERT_TRUE(ball);
  EXPECT_LT((ball->center - truth.center).norm(), 1e-6);
}

TEST(Ball, HostileOutlines) {
  const Camera camera = WideCamera();
  EXPECT_FALSE(BallFromOutline(camera, {}));
  EXPECT_FALSE(BallFromOutline(camera, {{1, 1}, {2, 2}, {3, 3}, {4, 5}}));
  EXPECT_FALSE(BallFromOutline(camera, std::vector<Eigen::Vector2d>(10, Eigen::Vector2d(100, 100))));
}

TEST(LightFromShading, FindsTheLightOfADiffuseBall) {
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, 0.01);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (const Eigen::Vector3d& l : {Eigen::Vector3d(0.3, -0.5, -0.8), Eigen::Vector3d(0.9, 0.1, -0.3)}) {
    std::vector<ShadedPixel> pixels;
    while (pixels.size() < 4000) {
      Eigen::Vector3d n(uniform(random), uniform(random), 0);
      if (n.squaredNorm() > 0.95) continue;
      n.z() = -std::sqrt(1 - n.squaredNorm());
      double value = 0.05 + 0.6 * std::max(0.0, n.dot(l.normalized())) + noise(random);
      if (n.dot((l.normalized() - Eigen::Vector3d::UnitZ()).normalized()) > 0.98) value = 1;  // a gloss
      pixels.push_back({n, value});
    }
    const auto fit = LightFromShading(pixels);
    ASSERT_TRUE(fit);
    EXPECT_LT(AngleDeg(fit->direction, l), 0.5);
    EXPECT_NEAR(fit->ambient, 0.05 / 0.6, 0.02);
    EXPECT_GT(fit->sigma_deg, 0);
  }
}

TEST(LightFromShading, NothingToSee) {
  EXPECT_FALSE(LightFromShading({}));
  std::vector<ShadedPixel> flat(1000, {-Eigen::Vector3d::UnitZ(), 0.0});
  EXPECT_FALSE(LightFromShading(flat));
}

}  // namespace
}  // namespace glint
