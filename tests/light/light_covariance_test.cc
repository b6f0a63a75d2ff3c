#include "light/light_covariance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "light/light_adjust.h"
#include "tests/support/ellipsoid_scene.h"

namespace glint {
namespace {

double AngleDeg(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) * 180 / M_PI;
}

// Exact highlights whose normals are seen through a seed that is too flat, and noisy.
std::vector<LightObservation> Flattened(const Light& light, double flatness, double noise, uint32_t seed) {
  const testing::Ellipsoid shape;
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, noise);
  std::vector<LightObservation> observations;
  for (const Contact& c : testing::MakeEllipsoidContacts(shape, {light}, 40, 0).contacts) {
    Eigen::Vector3d n = HalfVector(light, c.cam_from_world, c.SurfacePosition());
    n = (n + Eigen::Vector3d(0, 0, flatness * n.z()) + Eigen::Vector3d(normal(random), normal(random), normal(random)))
            .normalized();
    observations.push_back({c.cam_from_world, c.SurfacePosition(), n});
  }
  return observations;
}

TEST(LightCovariance, IsHonestWhetherNormalsErrOneByOneOrTogether) {
  int within = 0, runs = 0;
  const Light truth = testing::DistantLight(0.5, -0.4, 0.9);
  const double diagonal = testing::Ellipsoid().Diagonal();
  for (uint32_t seed = 1; seed <= 12; ++seed)
    for (const double flatness : {-0.15, 0.0, 0.2}) {
      const auto observations = Flattened(truth, flatness, 0.05, seed);
      const Eigen::VectorXd all = Eigen::VectorXd::Ones(static_cast<long>(observations.size()));
      Light light = truth;
      for (int round = 0; round < 5; ++round) AdjustLight(observations, all, 65, diagonal, 0, light);
      const double sigma = LargestSigma(LightCovariance(observations, all, 0.05, 65, diagonal, 0, light), light);
      EXPECT_LT(sigma, 8);
      within += AngleDeg(light.vector, truth.vector) < 2 * sigma;
      ++runs;
    }
  EXPECT_GE(within, 0.9 * runs);
}

}  // namespace
}  // namespace glint
