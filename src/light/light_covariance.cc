#include "light/light_covariance.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/parallel.h"
#include "core/square.h"
#include "light/light_adjust.h"

namespace glint {
namespace {

constexpr int kMapSize = 6;                                   // coefficients of a symmetric map
constexpr double kFreedom = 3;                                // of Student's distribution, as in FitLights()
constexpr double kReaches[] = {0.03, 0.07, 0.16, 0.4};        // of errors that neighbours share, diagonals
constexpr double kSharedParts[] = {0, 0.3, 0.6, 0.85, 0.95};  // of the variance
constexpr double kMapSigmas[] = {0, 1, 3};                    // of the map's coefficients, in the normals' sigma
constexpr double kLikelySigma = 1 * M_PI / 180;               // of the normals, worth two measurements
constexpr size_t kMostJudged = 100;                           // highlights say which hypothesis is likely

// h(light) - n = J d + e at the light, across the half vectors, scaled by the square roots of the weights.
struct WeightedRows {
  Eigen::VectorXd residual;
  Eigen::MatrixXd jacobian, map;  // rows: two an observation; by the light's coordinates, by the map's coefficients
  std::vector<Eigen::Vector3d> positions;         // diagonals
  std::vector<Eigen::Matrix<double, 3, 2>> axes;  // that the rows are along, times the square root

  size_t size() const { return positions.size(); }
};

// How the mapped normal changes with the map's coefficients: those of the diagonal, then xy, xz, yz.
Eigen::Matrix<double, 3, kMapSize> MapJacobian(const Eigen::Vector3d& n) {
  Eigen::Matrix<double, 3, kMapSize> change = Eigen::Matrix<double, 3, kMapSize>::Zero();
  for (int k = 0; k < 3; ++k) change(k, k) = n[k];
  constexpr int kPairs[3][2] = {{0, 1}, {0, 2}, {1, 2}};
  for (int k = 0; k < 3; ++k) {
    const auto [a, b] = kPairs[k];
    change(a, 3 + k) = n[b];
    change(b, 3 + k) = n[a];
  }
  return change;
}

WeightedRows MakeRows(const std::vector<LightObservation>& observations, const Eigen::VectorXd& responsibilities,
                      double sigma, double max_incidence_deg, double diagonal, const Light& light) {
  std::vector<size_t> of_light;
  for (size_t i = 0; i < observations.size(); ++i)
    if (responsibilities[i] > 0.5 && Disagreement(observations[i], light, max_incidence_deg) < 3) of_light.push_back(i);
  const int p = NumParameters(light), n = static_cast<int>(of_light.size());
  WeightedRows rows{Eigen::VectorXd(2 * n), Eigen::MatrixXd(2 * n, p), Eigen::MatrixXd(2 * n, kMapSize), {}, {}};
  for (Eigen::Index k = 0; k < n; ++k) {
    const LightObservation& o = observations[of_light[k]];
    const Eigen::Vector3d half = HalfVector(light, o.cam_from_world, o.position), r = half - o.normal;
    Eigen::Matrix<double, 3, 2> axes;
    axes.col(0) = half.unitOrthogonal();
    axes.col(1) = half.cross(axes.col(0));
    axes *= std::sqrt(responsibilities[of_light[k]] * (kFreedom + 2) / (kFreedom + r.squaredNorm() / (sigma * sigma)));
    rows.residual.segment<2>(2 * k) = axes.transpose() * r;
    rows.jacobian.middleRows<2>(2 * k) = axes.transpose() * HalfVectorJacobian(o, light, diagonal).leftCols(p);
    rows.map.middleRows<2>(2 * k) = axes.transpose() * MapJacobian(half);
    rows.positions.push_back(o.position / diagonal);
    rows.axes.push_back(axes);
  }
  return rows;
}

// At most so many of them, spread evenly.
WeightedRows Some(const WeightedRows& all, size_t most) {
  const size_t n = std::min(all.size(), most);
  WeightedRows some{
      Eigen::VectorXd(2 * n), Eigen::MatrixXd(2 * n, all.jacobian.cols()), Eigen::MatrixXd(2 * n, kMapSize), {}, {}};
  for (size_t k = 0; k < n; ++k) {
    const auto from = static_cast<long>(2 * (k * all.size() / n)), to = static_cast<long>(2 * k);
    some.residual.segment<2>(to) = all.residual.segment<2>(from);
    some.jacobian.middleRows<2>(to) = all.jacobian.middleRows<2>(from);
    some.map.middleRows<2>(to) = all.map.middleRows<2>(from);
    some.positions.push_back(all.positions[from / 2]);
    some.axes.push_back(all.axes[from / 2]);
  }
  return some;
}

// Correlation of the rows' errors if those of the normals fade over `reach`.
Eigen::MatrixXd SharedCorrelation(const WeightedRows& rows, double reach) {
  const auto n = static_cast<long>(rows.size());
  Eigen::MatrixXd correlation(2 * n, 2 * n);
  for (long a = 0; a < n; ++a)
    for (long b = 0; b <= a; ++b) {
      const double d = (rows.positions[a] - rows.positions[b]).norm() / reach;
      const Eigen::Matrix2d block = std::exp(-0.5 * d * d) * rows.axes[a].colwise().normalized().transpose() *
                                    rows.axes[b].colwise().normalized();
      correlation.block<2, 2>(2 * a, 2 * b) = block;
      correlation.block<2, 2>(2 * b, 2 * a) = block.transpose();
    }
  return correlation;
}

// How the errors of the normals may be distributed, up to their size.
struct Hypothesis {
  double reach, shared, map_sigma;
  double log_likelihood = 0, variance = 0;
};

std::vector<Hypothesis> Hypotheses() {
  std::vector<Hypothesis> all;
  for (const double map_sigma : kMapSigmas)
    for (const double reach : kReaches)
      for (const double shared : kSharedParts)
        if (shared > 0 || reach == kReaches[0]) all.push_back({reach, shared, map_sigma});
  return all;
}

// Restricted likelihood, the light projected out, and the most likely size of the errors.
void Judge(const WeightedRows& rows, const Eigen::MatrixXd& correlation, Hypothesis& h) {
  Eigen::MatrixXd matrix = h.shared * correlation + h.map_sigma * h.map_sigma * rows.map * rows.map.transpose();
  matrix.diagonal().array() += 1 - h.shared + 1e-9;
  const Eigen::LLT<Eigen::MatrixXd> cholesky(matrix);
  const Eigen::VectorXd y = cholesky.matrixL().solve(rows.residual);
  const Eigen::MatrixXd jacobian = cholesky.matrixL().solve(rows.jacobian);
  Eigen::MatrixXd normal = jacobian.transpose() * jacobian;
  normal.diagonal().array() += 1e-12 * normal.trace() + 1e-300;
  const Eigen::LLT<Eigen::MatrixXd> solver(normal);
  const Eigen::VectorXd of_y = jacobian.transpose() * y;
  const double squares = std::max(0.0, y.squaredNorm() - of_y.dot(solver.solve(of_y)));
  const auto freedom = static_cast<double>(std::max<long>(rows.residual.size() - rows.jacobian.cols(), 0));
  const double variance = (squares + 2 * kLikelySigma * kLikelySigma) / (freedom + 2);
  h.log_likelihood = -Eigen::MatrixXd(cholesky.matrixL()).diagonal().array().log().sum() -
                     Eigen::MatrixXd(solver.matrixL()).diagonal().array().log().sum() -
                     0.5 * (freedom + 2) * std::log(variance);
  h.variance = variance * (freedom + 2) / std::max(freedom, 1.0);
}

double LargestSigma(const Eigen::Matrix3d& covariance) {
  return std::sqrt(std::max(0.0, Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvalues()[2]));
}

}  // namespace

Eigen::Matrix3d LightCovariance(const std::vector<LightObservation>& observations,
                                const Eigen::VectorXd& responsibilities, double sigma, double max_incidence_deg,
                                double diagonal, double prior, const Light& light) {
  const WeightedRows rows = MakeRows(observations, responsibilities, sigma, max_incidence_deg, diagonal, light);
  const Eigen::Matrix3d basis = TangentBasis(light, diagonal);
  if (rows.size() < 2) return M_PI * M_PI * basis * basis.transpose();  // nothing is known
  const WeightedRows some = Some(rows, kMostJudged);
  std::vector<Hypothesis> hypotheses = Hypotheses();
  std::vector<Eigen::MatrixXd> correlations;
  for (const double reach : kReaches) correlations.push_back(SharedCorrelation(some, reach));
  const auto reach_of = [](const Hypothesis& h) { return std::find(kReaches, std::end(kReaches), h.reach) - kReaches; };
  ParallelFor(hypotheses.size(), 4,
              [&](size_t k) { Judge(some, correlations[reach_of(hypotheses[k])], hypotheses[k]); });
  double most = -std::numeric_limits<double>::infinity(), total = 0;
  for (const Hypothesis& h : hypotheses) most = std::max(most, h.log_likelihood);
  for (const Hypothesis& h : hypotheses) total += std::exp(h.log_likelihood - most);

  const int p = NumParameters(light);
  const bool flash = light.type == LightType::kPoint && light.frame == LightFrame::kCamera;
  const Eigen::MatrixXd& jacobian = rows.jacobian;
  const Eigen::MatrixXd squares = jacobian.transpose() * jacobian, by_map = jacobian.transpose() * rows.map;
  std::vector<Eigen::MatrixXd> shared;
  for (const double reach : kReaches)
    shared.push_back(jacobian.transpose() * SharedCorrelation(rows, reach) * jacobian);
  Eigen::MatrixXd normal = squares, meat = Eigen::MatrixXd::Zero(p, p);
  if (flash) normal.diagonal().array() += prior, meat.diagonal().array() += prior * sigma * sigma;
  for (const Hypothesis& h : hypotheses)
    meat += std::exp(h.log_likelihood - most) / total * h.variance *
            (h.shared * shared[reach_of(h)] + (1 - h.shared) * squares +
             h.map_sigma * h.map_sigma * by_map * by_map.transpose());
  normal.diagonal().array() += 1e-12 * normal.trace() + 1e-300;
  const Eigen::MatrixXd inverse = normal.ldlt().solve(Eigen::MatrixXd::Identity(p, p));
  const Eigen::MatrixXd spread = basis.leftCols(p) * inverse;
  return spread * meat * spread.transpose();
}

double HalfVectorSigma(const std::vector<LightObservation>& of_light, const Eigen::Matrix3d& covariance,
                       double diagonal, const Light& light) {
  const int p = NumParameters(light);
  const Eigen::MatrixXd coordinates =
      TangentBasis(light, diagonal).leftCols(p).completeOrthogonalDecomposition().pseudoInverse();
  double squares = 0;
  for (const LightObservation& o : of_light) {
    const Eigen::MatrixXd change = HalfVectorJacobian(o, light, diagonal).leftCols(p) * coordinates;
    squares += Square(LargestSigma(change * covariance * change.transpose()));
  }
  return std::sqrt(squares / std::max<double>(static_cast<double>(of_light.size()), 1));
}

double LargestSigma(const Eigen::Matrix3d& covariance, const Light& light) {
  const double largest = LargestSigma(covariance);
  return light.type == LightType::kPoint ? largest : std::min(largest * 180 / M_PI, 90.0);
}

}  // namespace glint
