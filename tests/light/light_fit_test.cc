#include "light/light_fit.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cfenv>
#include <cmath>
#include <random>

namespace glint {
namespace {

double AngleDeg(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) * 180 / M_PI;
}

// Cameras on a dome around a sphere of radius one at `center`; every light shows one highlight a view.
struct Simulated {
  Eigen::Vector3d center{0.4, -1, 2};
  double scale = 1;
  std::mt19937 random{7};

  Rigid3d Camera(int k, int count) const {
    const double azimuth = 2 * M_PI * k / count, elevation = 0.3 + 0.6 * ((k * 7) % count) / count;
    const Eigen::Vector3d out(std::cos(azimuth) * std::cos(elevation), std::sin(azimuth) * std::cos(elevation),
                              std::sin(elevation));
    Eigen::Matrix3d rotation;  // rows: the camera's axes in the world
    rotation.row(2) = -out;
    rotation.row(0) = Eigen::Vector3d::UnitZ().cross(out).normalized();
    rotation.row(1) = rotation.row(2).cross(rotation.row(0));
    Rigid3d cam_from_world;
    cam_from_world.rotation = Eigen::Quaterniond(rotation);
    cam_from_world.translation = -rotation * (scale * center + 4 * scale * out);
    return cam_from_world;
  }

  // The observation of a light, with the seed's normal off by `sigma_deg`; none where the sphere hides it.
  void Add(std::vector<LightObservation>& observations, const Light& light, double sigma_deg, int views = 40) {
    std::normal_distribution<double> noise(0, sigma_deg * M_PI / 180);
    for (int k = 0; k < views; ++k) {
      const Rigid3d cam = Camera(k, views);
      Eigen::Vector3d n = (cam.Inverse().translation - scale * center).normalized();
      for (int i = 0; i < 100; ++i) n = HalfVector(light, cam, scale * (center + n));
      const Eigen::Vector3d x = scale * (center + n);
      if (n.dot((cam.Inverse().translation - x).normalized()) < std::cos(60 * M_PI / 180)) continue;
      const Eigen::Vector3d e1 = n.unitOrthogonal(), e2 = n.cross(e1);
      observations.push_back({cam, x, (n + noise(random) * e1 + noise(random) * e2).normalized()});
    }
  }

  // Paint: anywhere on the sphere that the camera sees.
  void AddPaint(std::vector<LightObservation>& observations, int count) {
    std::normal_distribution<double> normal;
    while (count > 0) {
      const Rigid3d cam = Camera(count % 40, 40);
      const Eigen::Vector3d n = Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized();
      if (n.dot((cam.Inverse().translation - scale * (center + n)).normalized()) < 0.4) continue;
      observations.push_back({cam, scale * (center + n), n});
      --count;
    }
  }

  LightFit Fit(const std::vector<LightObservation>& observations, const LightFitOptions& options = {}) const {
    return FitLights(observations, scale * center, 3.46 * scale, options);
  }
};

Light Distant(const Eigen::Vector3d& direction, LightFrame frame = LightFrame::kWorld) {
  return {LightType::kDistant, frame, direction.normalized(), 0};
}

TEST(FitLights, TwoDistantLightsAmongPaintWithNoisyNormals) {
  Simulated scene;
  const Light a = Distant({0.6, -0.5, 0.7}), b = Distant({-0.3, 0.5, 0.8});
  std::vector<LightObservation> observations;
  scene.Add(observations, a, 6);
  scene.Add(observations, b, 6);
  scene.AddPaint(observations, 30);
  const LightFit fit = scene.Fit(observations);
  ASSERT_EQ(fit.lights.size(), 2u);
  for (const FoundLight& f : fit.lights) {
    EXPECT_EQ(f.light.type, LightType::kDistant);
    EXPECT_EQ(f.light.frame, LightFrame::kWorld);
    const double error = std::min(AngleDeg(f.light.vector, a.vector), AngleDeg(f.light.vector, b.vector));
    EXPECT_LT(error, 5);
    EXPECT_LT(error, 3 * f.light.sigma);
    EXPECT_LT((f.covariance * f.light.vector).norm(), 1e-9);  // none along the direction
    EXPECT_GT(f.criterion_gain, 10);
  }
}

TEST(FitLights, ANearLightIsToldFromADistantOne) {
  Simulated scene;
  const Light near{LightType::kPoint, LightFrame::kWorld, scene.center + Eigen::Vector3d(1.2, -1.6, 2.2), 0};
  std::vector<LightObservation> observations;
  scene.Add(observations, near, 1.5);
  const LightFit fit = scene.Fit(observations);
  ASSERT_EQ(fit.lights.size(), 1u);
  EXPECT_EQ(fit.lights[0].light.type, LightType::kPoint);
  EXPECT_LT((fit.lights[0].light.vector - near.vector).norm(), 0.4);

  std::vector<LightObservation> far;
  scene.Add(far, Distant({1.2, -1.6, 2.2}), 1.5);
  const LightFit distant = scene.Fit(far);
  ASSERT_EQ(distant.lights.size(), 1u);
  EXPECT_EQ(distant.lights[0].light.type, LightType::kDistant);
}

// A seed that is a little too flat as a whole, and off in patches: a lamp that stands nearer bends the half vectors as
// it bends the normals. How far it stands they do not tell, its direction they do.
TEST(FitLights, ABentSeedDoesNotBringADistantLightNear) {
  struct Case {
    double bend, noise_deg;
    int views;
  };
  const Light sun = Distant({0.6, -0.5, 0.7});
  for (const auto& [bend, noise_deg, views] : {Case{0.1, 2.5, 24}, Case{0.1, 3.5, 40}, Case{0.06, 2.5, 40}}) {
    Simulated scene;
    std::vector<LightObservation> observations;
    scene.Add(observations, sun, noise_deg, views);
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const LightObservation& o : observations) mean += o.normal / static_cast<double>(observations.size());
    std::normal_distribution<double> noise(0, 0.3 * noise_deg * M_PI / 180);
    std::array<Eigen::Vector3d, 4> of_patch;
    for (Eigen::Vector3d& off : of_patch)
      for (int axis = 0; axis < 3; ++axis) off[axis] = noise(scene.random);
    for (LightObservation& o : observations) {
      const int patch = (o.normal.x() > mean.x() ? 1 : 0) + (o.normal.y() > mean.y() ? 2 : 0);
      o.normal = (o.normal - bend * (o.normal - mean) + of_patch[patch]).normalized();
    }
    const LightFit fit = scene.Fit(observations);
    ASSERT_EQ(fit.lights.size(), 1u) << bend;
    const FoundLight& f = fit.lights[0];
    ASSERT_EQ(f.light.type, LightType::kDistant) << bend << ": " << f.light.vector.transpose() << ", " << f.light.sigma;
    EXPECT_LT(AngleDeg(f.light.vector, sun.vector), 3 * f.light.sigma) << bend;
  }
}

TEST(FitLights, ALampIsNotWhereItMayNotBe) {
  Simulated scene;
  const Light near{LightType::kPoint, LightFrame::kWorld, scene.center + Eigen::Vector3d(1.2, -1.6, 2.2), 0};
  std::vector<LightObservation> observations;
  scene.Add(observations, near, 1.5);
  LightFitOptions options;
  options.may_be_at = [&](const Eigen::Vector3d& lamp) { return (lamp - near.vector).norm() > 0.8; };
  const LightFit fit = scene.Fit(observations, options);
  for (const FoundLight& f : fit.lights)
    EXPECT_TRUE(f.light.type == LightType::kDistant || f.light.frame == LightFrame::kCamera ||
                options.may_be_at(f.light.vector))
        << f.light.vector.transpose();
}

TEST(FitLights, AVeryNearLightIsNotTwoDistantOnes) {
  Simulated left, right;
  left.center = {-1.5, 0, 0}, right.center = {1.5, 0, 0};
  const Light lamp{LightType::kPoint, LightFrame::kWorld, {0, 0.4, 2.8}, 0};
  std::vector<LightObservation> observations;
  left.Add(observations, lamp, 2);
  right.Add(observations, lamp, 2);
  const LightFit fit = FitLights(observations, Eigen::Vector3d::Zero(), 6, {});
  ASSERT_EQ(fit.lights.size(), 1u);
  EXPECT_EQ(fit.lights[0].light.type, LightType::kPoint);
  EXPECT_LT((fit.lights[0].light.vector - lamp.vector).norm(), 0.3);
  EXPECT_GT(fit.lights[0].support, 0.9 * static_cast<double>(observations.size()));
}

TEST(FitLights, AFlashAndALightThatTurnsWithTheCamera) {
  Simulated scene;
  std::vector<LightObservation> flash, turning;
  scene.Add(flash, {LightType::kPoint, LightFrame::kCamera, {0.2, -0.3, 0}, 0}, 3);
  scene.AddPaint(flash, 10);
  const LightFit a = scene.Fit(flash);
  ASSERT_EQ(a.lights.size(), 1u);
  EXPECT_EQ(a.lights[0].light.type, LightType::kPoint);
  EXPECT_EQ(a.lights[0].light.frame, LightFrame::kCamera);

  const Light beside = Distant({0.7, -0.3, -0.6}, LightFrame::kCamera);
  scene.Add(turning, beside, 3);
  const LightFit b = scene.Fit(turning);
  ASSERT_EQ(b.lights.size(), 1u);
  EXPECT_EQ(b.lights[0].light.type, LightType::kDistant);
  EXPECT_EQ(b.lights[0].light.frame, LightFrame::kCamera);
  EXPECT_LT(AngleDeg(b.lights[0].light.vector, beside.vector), 3);
}

TEST(FitLights, WhatMayBePaintUnderAMovingLightSpeaksForNone) {
  Simulated scene;
  std::vector<LightObservation> observations;
  scene.Add(observations, Distant({0.7, -0.3, -0.6}, LightFrame::kCamera), 2);
  const size_t honest = observations.size();
  // One mark that faces all cameras on one side looks like a light.
  for (int k = 0; k < 12; ++k) {
    LightObservation o = observations[k];
    o.normal = Eigen::Vector3d(1, 0.2, 0.4).normalized();
    o.position = scene.center + o.normal;
    o.may_move = false;
    observations.push_back(o);
  }
  const LightFit fit = scene.Fit(observations);
  ASSERT_EQ(fit.lights.size(), 1u);
  EXPECT_EQ(fit.lights[0].light.frame, LightFrame::kCamera);
  for (size_t i = honest; i < observations.size(); ++i) EXPECT_EQ(fit.assignment[i], -1);
}

TEST(FitLights, CrowdsOfPaintDoNotHideAFlash) {
  Simulated scene;
  std::vector<LightObservation> observations;
  scene.Add(observations, {LightType::kPoint, LightFrame::kCamera, Eigen::Vector3d::Zero(), 0}, 2, 24);
  // Marks on four sides, each seen by the cameras that face it: broadly, a standing light is mirrored there.
  std::normal_distribution<double> noise(0, 0.16);
  for (const Eigen::Vector3d& side : {Eigen::Vector3d(1, 0, 0.8), Eigen::Vector3d(-1, 0, 0.8),
                                      Eigen::Vector3d(0, 1, 0.8), Eigen::Vector3d(0, -1, 0.8)})
    for (int k = 0; k < 40; ++k) {
      const Rigid3d cam = scene.Camera(k, 40);
      const Eigen::Vector3d half = HalfVector(Distant(side), cam, scene.center);
      const Eigen::Vector3d n =
          (half + Eigen::Vector3d(noise(scene.random), noise(scene.random), noise(scene.random))).normalized();
      if (n.dot((cam.Inverse().translation - scene.center).normalized()) < 0.5) continue;
      observations.push_back({cam, scene.center + n, n, false});
    }
  const LightFit fit = scene.Fit(observations);
  const auto flash = std::find_if(fit.lights.begin(), fit.lights.end(),
                                  [](const FoundLight& f) { return f.light.type == LightType::kPoint; });
  ASSERT_NE(flash, fit.lights.end());
  EXPECT_EQ(flash->light.frame, LightFrame::kCamera);
  EXPECT_LT(flash->normal_sigma_deg, 4);
  EXPECT_GT(flash->support, 15);
}

TEST(FitLights, AFlashIsFoundAmongMuchThatMayBePaint) {
  Simulated scene;
  std::vector<LightObservation> observations;
  scene.Add(observations, {LightType::kPoint, LightFrame::kCamera, Eigen::Vector3d::Zero(), 0}, 4, 8);
  const size_t honest = observations.size();
  scene.AddPaint(observations, 170);
  for (size_t i = honest; i < observations.size(); ++i) observations[i].may_move = false;
  const LightFit fit = scene.Fit(observations);
  ASSERT_EQ(fit.lights.size(), 1u);
  EXPECT_EQ(fit.lights[0].light.frame, LightFrame::kCamera);
  EXPECT_EQ(fit.lights[0].light.type, LightType::kPoint);
}

TEST(FitLights, DoesNotDependOnTheScale) {
  for (const double scale : {1e-6, 1e6}) {
    Simulated scene;
    scene.scale = scale;
    std::vector<LightObservation> observations;
    scene.Add(observations,
              {LightType::kPoint, LightFrame::kWorld, scale * (scene.center + Eigen::Vector3d(1, 1, 2)), 0}, 1.5);
    const LightFit fit = scene.Fit(observations);
    ASSERT_EQ(fit.lights.size(), 1u) << scale;
    EXPECT_EQ(fit.lights[0].light.type, LightType::kPoint);
    EXPECT_LT((fit.lights[0].light.vector / scale - scene.center - Eigen::Vector3d(1, 1, 2)).norm(), 0.4);
  }
}

TEST(FitLights, NothingOneAndAllInOnePlace) {
  Simulated scene;
  std::feclearexcept(FE_ALL_EXCEPT);
  EXPECT_TRUE(scene.Fit({}).lights.empty());
  EXPECT_FALSE(std::fetestexcept(FE_INVALID)) << "no share of nothing";
  std::vector<LightObservation> observations;
  scene.Add(observations, Distant({0.6, -0.5, 0.7}), 1);
  EXPECT_TRUE(scene.Fit({observations[0]}).lights.empty());
  // The same place seen by one camera again and again: whatever is found says how little it is worth.
  const std::vector<LightObservation> same(30, observations[0]);
  for (const FoundLight& f : scene.Fit(same).lights) EXPECT_GT(f.support, 0);
  std::vector<LightObservation> paint;
  scene.AddPaint(paint, 40);
  EXPECT_TRUE(scene.Fit(paint).lights.empty());
}

}  // namespace
}  // namespace glint
