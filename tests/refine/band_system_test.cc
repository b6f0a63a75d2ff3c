#include "refine/band_system.h"

#include <cmath>
#include <functional>
#include <random>

#include <gmock/gmock.h>

#include "sdf/mesh_to_level_set.h"
#include "tests/support/shapes.h"

namespace glint {
namespace {

constexpr double kVoxel = 0.1;

LevelSet Sphere() { return MeshToLevelSet(testing::Icosphere(3), kVoxel); }

BandWeights Weights(const Band& band) {
  BandWeights weights;
  weights.n.resize(band.size());
  for (size_t i = 0; i < band.size(); ++i) weights.n[i] = band.Position(i).normalized().cast<float>();
  weights.pull.assign(band.size(), 0);
  weights.pull_target.assign(band.size(), 0);
  return weights;
}

std::vector<double> Values(const Band& band, const std::function<double(const Eigen::Vector3d&)>& f) {
  std::vector<double> values(band.size());
  for (size_t i = 0; i < band.size(); ++i) values[i] = f(band.Position(i));
  return values;
}

TEST(Band, NeighboursAndPositionsAgree) {
  const Band band(Sphere());
  ASSERT_GT(band.size(), 1000u);
  for (size_t i = 0; i < band.size(); ++i) {
    EXPECT_EQ(band.Find(band.Coord(i)), static_cast<int32_t>(i));
    EXPECT_NEAR(band.phi()[i], band.Position(i).norm() - 1, 0.02);
    for (int axis = 0; axis < 3; ++axis)
      for (int side = 0; side < 2; ++side) {
        const int32_t j = band.Neighbor(i, axis, side);
        if (j == Band::kNone) continue;
        EXPECT_EQ(band.Neighbor(j, axis, 1 - side), static_cast<int32_t>(i));
        EXPECT_NEAR((band.Position(j) - band.Position(i))[axis], side ? kVoxel : -kVoxel, 1e-9);
      }
  }
}

TEST(Band, TrilinearWeightsReproduceLinearFunctions) {
  const Band band(Sphere());
  const Eigen::Vector3d gradient(0.3, -2, 1);
  const auto values = Values(band, [&](const Eigen::Vector3d& x) { return gradient.dot(x); });
  const Eigen::Vector3d x = Eigen::Vector3d(1, 2, 3).normalized();
  std::array<int32_t, 8> voxels;
  std::array<double, 8> weights;
  ASSERT_TRUE(band.Trilinear(x, voxels, weights));
  double sum = 0;
  for (int k = 0; k < 8; ++k) sum += weights[k] * values[voxels[k]];
  EXPECT_NEAR(sum, gradient.dot(x), 1e-12);
  EXPECT_FALSE(band.Trilinear(Eigen::Vector3d::Zero(), voxels, weights));
}

TEST(BandSystem, LinearFunctionsHaveNoSmoothnessEnergy) {
  const Band band(Sphere());
  const BandSystem system(band, Weights(band));
  const auto linear = Values(band, [](const Eigen::Vector3d& x) { return 3 * x[0] - x[1] + 2; });
  EXPECT_NEAR(system.Energy(linear), 0, 1e-9);
}

TEST(BandSystem, MeasuresTheHessianOfAQuadratic) {
  const Band band(Sphere());
  const BandSystem system(band, Weights(band));
  // ‖H‖² = 4 for x², 2 for xy: energies in the ratio of the differences that the band holds.
  const double squares = system.Energy(Values(band, [](const Eigen::Vector3d& x) { return x[0] * x[0]; }));
  const double mixed = system.Energy(Values(band, [](const Eigen::Vector3d& x) { return x[0] * x[1]; }));
  size_t num_second = 0, num_mixed = 0;
  for (size_t i = 0; i < band.size(); ++i) {
    num_second += band.Neighbor(i, 0, 0) != Band::kNone && band.Neighbor(i, 0, 1) != Band::kNone;
    num_mixed += band.Diagonal(i, 0, 1, 1, 1) != Band::kNone && band.Neighbor(i, 1, 1) != Band::kNone;
  }
  const double h4 = std::pow(kVoxel, 4);
  EXPECT_NEAR(squares, 4 * h4 * num_second, 1e-4 * squares);
  EXPECT_NEAR(mixed, 2 * h4 * num_mixed, 1e-4 * mixed);
}

TEST(BandSystem, SolvesToTheMinimum) {
  const Band band(Sphere());
  BandWeights weights = Weights(band);
  weights.normal = 0.5;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (size_t i = 0; i < band.size(); ++i) {
    weights.pull[i] = 0.01f;
    weights.pull_target[i] = band.phi()[i];
  }
  BandSystem system(band, weights);
  BandRows rows;
  for (int k = 0; k < 50; ++k) {
    rows.Push(static_cast<int32_t>(k * band.size() / 50), 1);
    rows.Push(static_cast<int32_t>(k * band.size() / 50 + 1), 0.5);
    rows.Close(0.1 * uniform(random), 2);
  }
  system.SetRows(rows);
  std::vector<double> phi(band.phi().begin(), band.phi().end());
  const SolveReport report = system.Solve(2000, 1e-7, phi);
  EXPECT_LT(report.relative_residual, 1e-6);
  EXPECT_LT(report.final_energy, report.initial_energy);
  for (int trial = 0; trial < 5; ++trial) {
    std::vector<double> other = phi;
    for (double& value : other) value += 1e-3 * uniform(random);
    EXPECT_GT(system.Energy(other), report.final_energy);
  }
}

TEST(BandSystem, WithPullAloneReturnsItsTarget) {
  const Band band(Sphere());
  BandWeights weights = Weights(band);
  weights.smoothness = 0;
  weights.pull.assign(band.size(), 3);
  for (size_t i = 0; i < band.size(); ++i) weights.pull_target[i] = static_cast<float>(0.1 * std::sin(7.0 * i));
  const BandSystem system(band, weights);
  std::vector<double> phi(band.size(), 0);
  system.Solve(10, 1e-12, phi);
  for (size_t i = 0; i < band.size(); ++i) EXPECT_NEAR(phi[i], weights.pull_target[i], 1e-7);
}

}  // namespace
}  // namespace glint
