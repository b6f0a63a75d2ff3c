#include "refine/band_system.h"

#include <cmath>
#include <utility>

#include "core/check.h"
#include "core/parallel.h"
#include "core/random_bits.h"
#include "core/square.h"
#include "refine/dot.h"

namespace glint {
namespace {

constexpr size_t kGrain = 1 << 13;

}  // namespace

BandSystem::BandSystem(const Band& band, BandWeights weights, BandRows rows)
    : weights_(std::move(weights)),
      operator_(band, weights_, std::move(rows)),
      voxel_size_(static_cast<float>(band.voxel_size())) {
  GLINT_CHECK_EQ(weights_.pull_target.size(), band.size());
  BuildTargets();
  BuildRightHandSide();
}

void BandSystem::BuildTargets() {
  const size_t n = weights_.n.size();
  target_differences_.assign(n + 1, {});
  if (!weights_.reference.empty()) {
    GLINT_CHECK_EQ(weights_.reference.size(), n);
    operator_.TakeDifferences(weights_.reference, target_differences_);
  }
  for (size_t i = 0; i < n; ++i) {
    // Where the reference is not known, no bending is the best guess.
    for (float& value : target_differences_[i])
      if (!std::isfinite(value)) value = 0;
    target_differences_[i][6] = operator_.Interior(i) ? voxel_size_ : 0;
  }
}

void BandSystem::SetReference(std::vector<float> reference) {
  weights_.reference = std::move(reference);
  BuildTargets();
  BuildRightHandSide();
}

void BandSystem::SetRowWeights(const std::vector<double>& weight) {
  GLINT_CHECK_EQ(weight.size(), rows().size());
  operator_.SetRowWeights(weight);
  if (multigrid_) multigrid_->UpdateRowWeights();
  BuildRightHandSide();
}

void BandSystem::BuildRightHandSide() {
  const size_t n = weights_.n.size();
  std::vector<BandOperator::Weighted> weighted(n + 1);
  operator_.WeighDifferences(target_differences_, weighted);
  std::vector<double> row_values(rows().size());
  for (size_t r = 0; r < rows().size(); ++r) row_values[r] = rows().weight[r] * rows().target[r];
  rhs_.resize(n);
  ParallelFor(n, kGrain, [&](size_t i) {
    rhs_[i] = operator_.GatherDifferences(weighted, i) +
              static_cast<double>(weights_.pull[i]) * weights_.pull_target[i] + operator_.GatherRows(row_values, i);
  });
}

double BandSystem::Energy(const std::vector<double>& phi) const {
  std::vector<BandOperator::Differences> differences;
  operator_.TakeDifferences(phi, differences);
  ParallelFor(phi.size(), kGrain, [&](size_t i) {
    for (int k = 0; k < 7; ++k) differences[i][k] -= target_differences_[i][k];
  });
  double energy = ParallelSum(phi.size(), kGrain, 0.0, [&](size_t begin, size_t end) {
    double sum = operator_.DifferencesEnergy(differences, begin, end);
    for (size_t i = begin; i < end; ++i) sum += weights_.pull[i] * Square(phi[i] - weights_.pull_target[i]);
    return sum;
  });
  for (size_t r = 0; r < rows().size(); ++r) {
    const double residual = rows().Dot(r, phi) - rows().target[r];
    energy += rows().weight[r] * residual * residual;
  }
  return energy;
}

SolveReport BandSystem::Solve(int max_iterations, double tolerance, std::vector<double>& phi) {
  GLINT_CHECK_EQ(phi.size(), rhs_.size());
  const double initial_energy = Energy(phi);
  SolveReport report = Minimize(rhs_, max_iterations, tolerance, phi);
  report.initial_energy = initial_energy;
  report.final_energy = Energy(phi);
  return report;
}

std::vector<double> BandSystem::Deviation(uint64_t seed, const std::vector<double>& row_noise, int max_iterations,
                                          double tolerance) {
  GLINT_CHECK_EQ(row_noise.size(), rows().size());
  const size_t n = weights_.n.size();
  std::vector<BandOperator::Weighted> weighted(n + 1);
  operator_.WeighNoise(seed, weighted);
  const auto sign = [&](size_t place) { return (RandomBits(seed, place) & 1) != 0 ? 1.0 : -1.0; };
  std::vector<double> row_values(rows().size());
  for (size_t r = 0; r < rows().size(); ++r)
    row_values[r] = std::sqrt(rows().weight[r]) * sign(2 * n + r) + rows().weight[r] * row_noise[r];
  std::vector<double> rhs(n), deviation(n, 0);
  ParallelFor(n, kGrain, [&](size_t i) {
    rhs[i] = operator_.GatherDifferences(weighted, i) + std::sqrt(static_cast<double>(weights_.pull[i])) * sign(n + i) +
             operator_.GatherRows(row_values, i);
  });
  Minimize(rhs, max_iterations, tolerance, deviation);
  return deviation;
}

SolveReport BandSystem::Minimize(const std::vector<double>& rhs, int max_iterations, double tolerance,
                                 std::vector<double>& phi) {
  if (!multigrid_) multigrid_ = std::make_unique<BandMultigrid>(operator_);
  SolveReport report;
  const size_t n = phi.size();
  std::vector<double> r(n), z(n), p(n), q;
  operator_.Apply(phi, q);
  ParallelFor(n, kGrain, [&](size_t i) { r[i] = rhs[i] - q[i]; });
  multigrid_->Apply(r, z);
  p = z;
  double rz = Dot(r, z);
  const double first = rz;
  while (report.iterations < max_iterations && rz > tolerance * tolerance * first && rz > 0) {
    operator_.Apply(p, q);
    const double pq = Dot(p, q);
    if (!(pq > 0)) break;  // the rest is in the null space, or rounding
    const double step = rz / pq;
    ParallelFor(n, kGrain, [&](size_t i) {
      phi[i] += step * p[i];
      r[i] -= step * q[i];
    });
    multigrid_->Apply(r, z);
    const double next = Dot(r, z);
    // Polak and Ribière's form: the cycle is not a linear map.
    const double ratio = -step * Dot(q, z) / rz;
    ParallelFor(n, kGrain, [&](size_t i) { p[i] = z[i] + ratio * p[i]; });
    rz = next;
    ++report.iterations;
  }
  report.relative_residual = first > 0 ? std::sqrt(std::abs(rz) / first) : 0;
  return report;
}

}  // namespace glint
