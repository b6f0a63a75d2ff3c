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

// How the normals of a seed are off.
struct Errors {
  double flat = 0;    // along z, as a whole
  double alone = 0;   // sigma of each
  double shared = 0;  // of what neighbours share
};

// Exact highlights whose normals are seen through a seed that is off.
std::vector<LightObservation> SeenWith(const Errors& errors, const Light& light, uint32_t seed) {
  const testing::Ellipsoid shape;
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  const auto vector = [&] { return Eigen::Vector3d(normal(random), normal(random), normal(random)); };
  // A sum of waves is a smooth random field.
  constexpr int kWaves = 40;
  std::vector<Eigen::Vector3d> direction, frequency, phase;
  for (int k = 0; k < kWaves; ++k) {
    direction.push_back(vector());
    frequency.push_back(vector() / (0.1 * shape.Diagonal()));
    phase.push_back(M_PI * vector());
  }
  std::vector<LightObservation> observations;
  for (const Contact& c : testing::MakeEllipsoidContacts(shape, {light}, 40, 0).contacts) {
    const Eigen::Vector3d x = c.SurfacePosition();
    Eigen::Vector3d n = HalfVector(light, c.cam_from_world, x), field = Eigen::Vector3d::Zero();
    for (int k = 0; k < kWaves; ++k)
      field += std::sqrt(2.0 / kWaves) * std::cos(frequency[k].dot(x) + phase[k].x()) * direction[k];
    n = (n + Eigen::Vector3d(0, 0, errors.flat * n.z()) + errors.alone * vector() + errors.shared * field).normalized();
    observations.push_back({c.cam_from_world, x, n});
  }
  return observations;
}

struct Honesty {
  int runs = 0, within = 0;  // two standard deviations
  double squares = 0, claimed = 0;
};

Honesty Measure(const Light& truth, const Errors& errors) {
  Honesty honesty;
  const double diagonal = testing::Ellipsoid().Diagonal();
  for (uint32_t seed = 1; seed <= 20; ++seed) {
    const auto observations = SeenWith(errors, truth, seed);
    const Eigen::VectorXd all = Eigen::VectorXd::Ones(static_cast<long>(observations.size()));
    Light light = truth;
    for (int round = 0; round < 5; ++round) AdjustLight(observations, all, 65, diagonal, 0, light);
    const double sigma_deg = LargestSigma(LightCovariance(observations, all, 0.05, 65, diagonal, 0, light), light);
    const double error_deg = AngleDeg(light.vector, truth.vector);
    ++honesty.runs;
    honesty.within += error_deg < 2 * sigma_deg;
    honesty.squares += error_deg * error_deg;
    honesty.claimed += 2 * sigma_deg * sigma_deg;  // at most: the other direction is known better
  }
  return honesty;
}

TEST(LightCovariance, IsHonestWhetherNormalsErrOneByOneOrTogether) {
  const Light truth = testing::DistantLight(0.5, -0.4, 0.9);
  int within = 0, runs = 0;
  for (const Errors& errors :
       {Errors{0, 0.05, 0}, Errors{0, 0.02, 0.06}, Errors{-0.15, 0.05, 0}, Errors{0.2, 0.05, 0}}) {
    const Honesty honesty = Measure(truth, errors);
    within += honesty.within;
    runs += honesty.runs;
    EXPECT_GE(honesty.within, 0.75 * honesty.runs) << errors.flat << " " << errors.shared;
  }
  EXPECT_GE(within, 0.9 * runs);
}

TEST(LightCovariance, ClaimsNoMoreThanThereIs) {
  const Light truth = testing::DistantLight(0.5, -0.4, 0.9);
  for (const Errors& errors : {Errors{0, 0.05, 0}, Errors{0, 0.02, 0.06}}) {
    const Honesty honesty = Measure(truth, errors);
    EXPECT_LT(honesty.claimed, 6 * honesty.squares) << errors.shared;
    EXPECT_GT(honesty.claimed, honesty.squares) << errors.shared;
  }
}

}  // namespace
}  // namespace glint
