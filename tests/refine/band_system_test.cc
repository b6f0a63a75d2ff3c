#include "refine/band_system.h"

#include <gmock/gmock.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <random>

#include "core/square.h"
#include "refine/band_transfer.h"
#include "refine/row_gram.h"
#include "refine/row_sample.h"
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

TEST(RowBuilder, SaysOneThingOfAVoxel) {
  BandRows rows;
  RowBuilder row(5);
  row.Push(3, 0.5);
  row.Push(1, 2);
  row.Push(3, 0.25);
  row.Close(7, 9, rows);
  row.Push(1, -1);
  row.Close(0, 1, rows);
  EXPECT_EQ(rows.begin, (std::vector<size_t>{0, 2, 3}));
  EXPECT_EQ(rows.voxel, (std::vector<int32_t>{3, 1, 1}));
  EXPECT_EQ(rows.coefficient, (std::vector<float>{0.75F, 2, -1}));
  EXPECT_EQ(rows.target, (std::vector<double>{7, 0}));
  EXPECT_EQ(rows.weight, (std::vector<double>{9, 1}));
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
  BandRows rows;
  for (int k = 0; k < 50; ++k) {
    rows.Push(static_cast<int32_t>(k * band.size() / 50), 1);
    rows.Push(static_cast<int32_t>(k * band.size() / 50 + 1), 0.5);
    rows.Close(0.1 * uniform(random), 2);
  }
  BandSystem system(band, weights, rows);
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
  BandSystem system(band, weights);
  std::vector<double> phi(band.size(), 0);
  system.Solve(10, 1e-12, phi);
  for (size_t i = 0; i < band.size(); ++i) EXPECT_NEAR(phi[i], weights.pull_target[i], 1e-7);
}

TEST(BandSystem, BendingIsMeasuredAgainstTheReference) {
  const Band band(Sphere());
  BandWeights weights = Weights(band);
  weights.bend_change = 2;
  const auto wave = Values(band, [](const Eigen::Vector3d& x) { return 0.1 * std::sin(5 * x[0]) * x[1]; });
  weights.reference.assign(wave.begin(), wave.end());
  EXPECT_NEAR(BandSystem(band, weights).Energy(wave), 0, 1e-6);
  // Where it is not known, no bending is the target; nothing becomes NaN.
  weights.reference[band.size() / 2] = std::numeric_limits<float>::quiet_NaN();
  const double energy = BandSystem(band, weights).Energy(wave);
  EXPECT_TRUE(std::isfinite(energy));
  EXPECT_GT(energy, 1e-4);
}

TEST(BandSystem, AConstantBendHasNoChange) {
  const Band band(Sphere());
  BandWeights weights = Weights(band);
  weights.smoothness = 0;
  weights.bend_change = 1;
  const BandSystem system(band, weights);
  const auto quadratic = Values(band, [](const Eigen::Vector3d& x) { return x[0] * x[0] - 2 * x[1] * x[2] + x[0]; });
  EXPECT_NEAR(system.Energy(quadratic), 0, 1e-6);
  EXPECT_GT(system.Energy(Values(band, [](const Eigen::Vector3d& x) { return std::pow(x[0], 3); })), 1e-3);
}

// Weights as the level set has them, and normals at a few places.
struct Problem {
  BandWeights weights;
  BandRows rows;
};

Problem LevelSetProblem(const Band& band) {
  const double h = band.voxel_size(), area = 4 * M_PI / static_cast<double>(band.size());
  Problem problem{Weights(band), {}};
  problem.weights.smoothness = 30 * area / std::pow(h, 4);
  problem.weights.bend_change = problem.weights.smoothness * Square(0.2 / h);
  problem.weights.normal = 10 * area / (h * h);
  problem.weights.pull.assign(band.size(), static_cast<float>(1e4 * area));
  problem.weights.pull_target = problem.weights.reference = band.phi();
  for (int k = 0; k < 60; ++k) {
    const Eigen::Vector3d x = Eigen::Vector3d(std::cos(7.0 * k), std::sin(3.0 * k), std::cos(2.0 * k)).normalized();
    const Eigen::Vector3d t = x.unitOrthogonal();
    const int32_t v = band.Find(band.ToIndexSpace(x).array().round().cast<int>());
    for (int axis = 0; axis < 3; ++axis) {
      problem.rows.Push(band.Neighbor(v, axis, 1), t[axis] / (2 * h));
      problem.rows.Push(band.Neighbor(v, axis, 0), -t[axis] / (2 * h));
    }
    problem.rows.Close(0.02 * std::sin(5.0 * k), 1e4);
  }
  return problem;
}

// Against the matrix itself, inverted: a coarse sphere, every kind of term.
TEST(BandSystem, DeviationsHaveTheInverseOfTheMatrixAsCovariance) {
  const Band band(MeshToLevelSet(testing::Icosphere(2), 0.45));
  const size_t n = band.size();
  ASSERT_LT(n, 900u);
  BandWeights weights = Weights(band);
  weights.smoothness = 2;
  weights.bend_change = 3;
  weights.normal = 0.5;
  weights.pull.assign(n, 0.02f);
  BandRows rows;
  for (size_t i = 0; i + 7 < n; i += 9) {
    rows.Push(static_cast<int32_t>(i), 1);
    rows.Push(static_cast<int32_t>(i + 7), -0.4);
    rows.Close(0.3, 1.5);
  }
  BandOperator matrix(band, weights, rows);
  Eigen::MatrixXd a(n, n);
  for (size_t j = 0; j < n; ++j) {
    std::vector<double> unit(n, 0), column;
    unit[j] = 1;
    matrix.Apply(unit, column);
    a.col(static_cast<Eigen::Index>(j)) = Eigen::Map<Eigen::VectorXd>(column.data(), static_cast<Eigen::Index>(n));
  }
  const Eigen::VectorXd expected = a.inverse().diagonal();
  BandSystem system(band, weights, rows);
  constexpr int kSamples = 800;
  Eigen::VectorXd measured = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(n));
  for (int k = 0; k < kSamples; ++k) {
    const std::vector<double> deviation =
        system.Deviation(static_cast<uint64_t>(k) << 32, std::vector<double>(rows.size(), 0), 200, 1e-3);
    for (size_t i = 0; i < n; ++i) measured[static_cast<Eigen::Index>(i)] += deviation[i] * deviation[i] / kSamples;
  }
  // A variance of 800 samples is good to 5 % (one standard deviation); their mean over all voxels to far less.
  const Eigen::VectorXd ratio = measured.cwiseQuotient(expected);
  EXPECT_NEAR(ratio.mean(), 1, 0.05);
  EXPECT_GT(ratio.minCoeff(), 0.75);
  EXPECT_LT(ratio.maxCoeff(), 1.3);
}

TEST(BandOperator, IsSymmetricAndItsScaledEigenvaluesAreAtMostOne) {
  const Band band(Sphere());
  const Problem problem = LevelSetProblem(band);
  const BandOperator matrix(band, problem.weights, problem.rows);
  const auto a = Values(band, [](const Eigen::Vector3d& x) { return std::sin(9 * x[0] + x[1]); });
  const auto b = Values(band, [](const Eigen::Vector3d& x) { return std::cos(7 * x[2]) * x[1]; });
  std::vector<double> product_a, product_b;
  matrix.Apply(a, product_a);
  matrix.Apply(b, product_b);
  const auto dot = [](const std::vector<double>& x, const std::vector<double>& y) {
    return std::inner_product(x.begin(), x.end(), y.begin(), 0.0);
  };
  EXPECT_NEAR(dot(b, product_a), dot(a, product_b), 1e-4 * std::abs(dot(a, product_a)));
  // Power iteration.
  const std::vector<float> inverse = matrix.InverseAbsoluteRowSums();
  std::vector<double> x = a;
  double eigenvalue = 0;
  for (int k = 0; k < 60; ++k) {
    matrix.Apply(x, product_a);
    for (size_t i = 0; i < x.size(); ++i) product_a[i] *= inverse[i];
    eigenvalue = std::sqrt(dot(product_a, product_a) / dot(x, x));
    x = product_a;
    for (double& value : x) value /= eigenvalue;
  }
  EXPECT_LE(eigenvalue, 1.0001);
  EXPECT_GT(eigenvalue, 0.3);
}

TEST(BandOperator, DenseIsWhatApplySays) {
  const Band band(MeshToLevelSet(testing::Icosphere(2), 0.45));
  const auto n = static_cast<int32_t>(band.size());
  BandWeights weights = Weights(band);
  weights.bend_change = 3;
  weights.pull.assign(band.size(), 0.02f);
  for (const int rows_a_voxel : {3, 6}) {  // one by one, and multiplied out
    BandRows rows;
    for (int32_t i = 0; i < rows_a_voxel * n; ++i) {
      rows.Push(i % n, 0.7);
      rows.Push((7 * i + 2) % n, -0.4);
      rows.Push(i % 5 == 0 ? i % n : (11 * i) % n, 0.3);  // some name a voxel twice
      rows.Close(0, 0.1 * (i % 4));
    }
    const BandOperator matrix(band, weights, rows);
    const Eigen::MatrixXf dense = matrix.Dense();
    std::vector<float> unit(band.size(), 0), column;
    for (int32_t j = 0; j < n; ++j) {
      unit[j] = 1;
      matrix.Apply(unit, column);
      unit[j] = 0;
      EXPECT_LE((dense.col(j) - Eigen::Map<Eigen::VectorXf>(column.data(), n)).lpNorm<Eigen::Infinity>(), 2e-6f) << j;
    }
  }
}

TEST(BandTransfer, ConstantsStayAndRestrictionIsTheTranspose) {
  const Band band(Sphere());
  const BandTransfer transfer(band);
  const size_t coarse_size = transfer.coarse().size();
  EXPECT_LT(coarse_size, band.size() / 2);
  std::vector<float> fine(band.size(), 0);
  transfer.AddProlonged(std::vector<float>(coarse_size, 1), fine);
  for (float value : fine) EXPECT_NEAR(value, 1, 1e-6);
  std::vector<float> coarse(coarse_size), restricted, prolonged(band.size(), 0);
  for (size_t c = 0; c < coarse_size; ++c) coarse[c] = static_cast<float>(std::sin(1.0 * c));
  for (size_t i = 0; i < fine.size(); ++i) fine[i] = static_cast<float>(std::cos(2.0 * i));
  transfer.AddProlonged(coarse, prolonged);
  transfer.Restrict(fine, restricted);
  EXPECT_NEAR(std::inner_product(fine.begin(), fine.end(), prolonged.begin(), 0.0),
              std::inner_product(coarse.begin(), coarse.end(), restricted.begin(), 0.0), 1e-3);
}

// Rows at random places of a sphere, a few of them a thousand times as heavy.
BandRows Crowd(const Band& band, int count) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  BandRows rows;
  std::array<int32_t, 8> voxels;
  std::array<double, 8> weights;
  for (int k = 0; k < count; ++k) {
    const Eigen::Vector3d x(normal(random), normal(random), normal(random));
    if (!band.Trilinear(x.normalized(), voxels, weights)) continue;
    for (int e = 0; e < 8; ++e) rows.Push(voxels[e], weights[e]);
    rows.Close(0.01 * x.normalized().z(), k % 100 == 0 ? 1000 : 1);
  }
  return rows;
}

TEST(RowSample, StandsForAll) {
  const Band band(Sphere());
  const BandRows few = Crowd(band, 500), many = Crowd(band, 100000);
  EXPECT_TRUE(RowSample(few, band.size(), 32).All());
  EXPECT_EQ(RowSample(few, band.size(), 32).Weights(few.weight), few.weight);
  const RowSample sample(many, band.size(), 32);
  const BandRows taken = sample.Taken(many);
  EXPECT_LT(taken.size(), many.size() / 2);
  EXPECT_EQ(taken.weight, sample.Weights(many.weight));
  std::vector<double> of_all(band.size(), 0), of_taken(band.size(), 0), count(band.size(), 0);
  for (size_t r = 0; r < many.size(); ++r) of_all[many.voxel[many.begin[r]]] += many.weight[r];
  for (size_t r = 0; r < taken.size(); ++r) {
    of_taken[taken.voxel[taken.begin[r]]] += taken.weight[r];
    ++count[taken.voxel[taken.begin[r]]];
  }
  for (size_t v = 0; v < band.size(); ++v) {
    EXPECT_NEAR(of_taken[v], of_all[v], 1e-9 * of_all[v]);
    EXPECT_LE(count[v], 40);
  }
  // Robust weights may be nothing for those that were taken.
  std::vector<double> weight(many.size(), 0);
  for (size_t r = 0; r < many.size(); r += 3) weight[r] = 2;
  const std::vector<double> of_sample = sample.Weights(weight);
  EXPECT_NEAR(std::accumulate(of_sample.begin(), of_sample.end(), 0.0),
              std::accumulate(weight.begin(), weight.end(), 0.0), 1e-6);
}

// Many rows are multiplied out: the same matrix as that of the rows one by one, on this band and on coarser ones.
TEST(RowGram, IsTheRowsMultipliedOut) {
  const Band band(MeshToLevelSet(testing::Icosphere(3), 0.2));
  const BandWeights weights = Weights(band);
  const BandRows many = Crowd(band, 20000);
  const BandOperator crowded(band, weights, many);
  ASSERT_TRUE(crowded.Crowded());
  const auto x = Values(band, [](const Eigen::Vector3d& p) { return std::sin(9 * p[0] + p[1]); });
  const auto product = [&](const BandRows& rows) {
    std::vector<double> sum(band.size(), 0);
    for (size_t r = 0; r < rows.size(); ++r)
      for (size_t e = rows.begin[r]; e < rows.begin[r + 1]; ++e)
        sum[rows.voxel[e]] += rows.weight[r] * rows.Dot(r, x) * rows.coefficient[e];
    return sum;
  };
  const std::vector<double> expected = product(many);
  double largest = 0;
  for (double value : expected) largest = std::max(largest, std::abs(value));
  for (size_t i = 0; i < band.size(); ++i) ASSERT_NEAR(crowded.Gram().Product(i, x), expected[i], 1e-9 * largest) << i;
  // Coarser.
  const BandTransfer transfer(band);
  const RowGram restricted = crowded.Gram().Restricted(transfer);
  const BandRows rows = transfer.Restrict(many);
  std::vector<double> coarse_x(transfer.coarse().size());
  for (size_t c = 0; c < coarse_x.size(); ++c) coarse_x[c] = std::cos(3.0 * static_cast<double>(c));
  std::vector<double> coarse(coarse_x.size(), 0);
  for (size_t r = 0; r < rows.size(); ++r)
    for (size_t e = rows.begin[r]; e < rows.begin[r + 1]; ++e)
      coarse[rows.voxel[e]] += rows.weight[r] * rows.Dot(r, coarse_x) * rows.coefficient[e];
  for (size_t c = 0; c < coarse.size(); ++c)
    ASSERT_NEAR(restricted.Product(c, coarse_x), coarse[c], 1e-5 * largest) << c;
}

TEST(RowGram, FollowsTheWeights) {
  const Band band(MeshToLevelSet(testing::Icosphere(3), 0.2));
  BandRows many = Crowd(band, 20000);
  BandSystem changed(band, Weights(band), many);
  std::vector<double> weight(many.size());
  for (size_t r = 0; r < weight.size(); ++r) weight[r] = many.target[r] > 0 ? 3 : 0.01;
  std::vector<double> a(band.phi().begin(), band.phi().end()), b = a, unused = a;
  changed.Solve(50, 1e-6, unused);  // with the first weights, so that there is something to forget
  changed.SetRowWeights(weight);
  changed.Solve(200, 1e-9, a);
  many.weight = weight;
  BandSystem made_so(band, Weights(band), many);
  made_so.Solve(200, 1e-9, b);
  for (size_t i = 0; i < a.size(); ++i) ASSERT_NEAR(a[i], b[i], 1e-6) << i;
}

TEST(BandMultigrid, ConvergesAsWellWhereRowsCrowd) {
  std::vector<int> iterations;
  for (int count : {2000, 100000}) {
    const Band band(Sphere());
    BandWeights weights = Weights(band);
    weights.smoothness = 10;
    weights.normal = 0.5;
    BandSystem system(band, weights, Crowd(band, count));
    std::vector<double> phi(band.phi().begin(), band.phi().end());
    const SolveReport report = system.Solve(500, 1e-4, phi);
    EXPECT_LT(report.relative_residual, 1e-4);
    iterations.push_back(report.iterations);
  }
  EXPECT_LT(iterations[1], 2 * iterations[0] + 3);
}

TEST(BandMultigrid, IterationsHardlyGrowAsVoxelsHalve) {
  std::vector<int> iterations;
  for (double voxel : {0.1, 0.05, 0.025}) {
    const Band band(MeshToLevelSet(testing::Icosphere(4), voxel));
    Problem problem = LevelSetProblem(band);
    BandSystem system(band, problem.weights, problem.rows);
    std::vector<double> phi(band.phi().begin(), band.phi().end());
    const SolveReport report = system.Solve(500, 1e-4, phi);
    EXPECT_LT(report.relative_residual, 1e-4);
    iterations.push_back(report.iterations);
  }
  // Conjugate gradients without the coarser bands would need eight times as many each time (sixth order).
  EXPECT_LT(iterations[1], 2 * iterations[0] + 3);
  EXPECT_LT(iterations[2], 2 * iterations[1] + 3);
  EXPECT_LT(iterations[2], 80);
}

// Coarse bands cannot hold what is held voxel by voxel: they are discretised anew and correct too much there.
TEST(BandMultigrid, IsPositiveWhereVoxelsAreHeld) {
  const Band band(MeshToLevelSet(testing::Icosphere(4), 0.025));
  Problem problem = LevelSetProblem(band);
  std::mt19937 random(5);
  for (size_t i = 0; i < band.size(); ++i)
    if (band.Position(i).z() < 0 || random() % 7 == 0) problem.weights.pull[i] = 1e6F;
  const BandOperator matrix(band, problem.weights, problem.rows);
  BandMultigrid cycle(matrix);
  std::normal_distribution<double> normal;
  std::vector<double> r(band.size()), z;
  for (int k = 0; k < 5; ++k) {
    for (double& value : r) value = normal(random);
    // At the end as smooth as the coarsest band has it.
    if (k == 4)
      for (size_t i = 0; i < r.size(); ++i) r[i] = band.Position(i).x() + 0.5;
    cycle.Apply(r, z);
    EXPECT_GT(std::inner_product(r.begin(), r.end(), z.begin(), 0.0), 0) << k;
  }
  BandSystem system(band, problem.weights, problem.rows);
  std::vector<double> phi(band.phi().begin(), band.phi().end());
  const SolveReport report = system.Solve(500, 1e-4, phi);
  EXPECT_LT(report.relative_residual, 1e-4);
  EXPECT_LT(report.iterations, 40);
}

}  // namespace
}  // namespace glint
