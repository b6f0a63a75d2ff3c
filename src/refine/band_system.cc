#include "refine/band_system.h"

#include <cmath>
#include <utility>

#include "core/check.h"
#include "core/parallel.h"

namespace glint {
namespace {

constexpr size_t kGrain = 1 << 13;
constexpr int kAxisA[3] = {0, 0, 1}, kAxisB[3] = {1, 2, 2};  // of the three mixed differences
constexpr float kMixed = static_cast<float>(M_SQRT2);        // ‖H‖² counts each mixed derivative twice

double Dot(const std::vector<double>& a, const std::vector<double>& b) {
  return ParallelSum(a.size(), kGrain, 0.0, [&](size_t begin, size_t end) {
    double sum = 0;
    for (size_t i = begin; i < end; ++i) sum += a[i] * b[i];
    return sum;
  });
}

}  // namespace

double BandRows::Dot(size_t row, const std::vector<double>& phi) const {
  double sum = 0;
  for (size_t e = begin[row]; e < begin[row + 1]; ++e) sum += coefficient[e] * phi[voxel[e]];
  return sum;
}

BandSystem::BandSystem(const Band& band, BandWeights weights)
    : band_(band), weights_(std::move(weights)), interior_(band.size()), differences_(band.size()) {
  GLINT_CHECK_EQ(weights_.n.size(), band.size());
  GLINT_CHECK_EQ(weights_.pull.size(), band.size());
  GLINT_CHECK_EQ(weights_.pull_target.size(), band.size());
  for (size_t i = 0; i < band.size(); ++i) interior_[i] = band.HasAllNeighbors(i);
  SetRows({});
}

void BandSystem::SetRows(BandRows rows) {
  rows_ = std::move(rows);
  by_voxel_begin_.assign(band_.size() + 1, 0);
  for (int32_t v : rows_.voxel) ++by_voxel_begin_[v + 1];
  for (size_t i = 0; i < band_.size(); ++i) by_voxel_begin_[i + 1] += by_voxel_begin_[i];
  by_voxel_row_.resize(rows_.voxel.size());
  by_voxel_coefficient_.resize(rows_.voxel.size());
  std::vector<size_t> next(by_voxel_begin_.begin(), by_voxel_begin_.end() - 1);
  for (size_t r = 0; r < rows_.size(); ++r)
    for (size_t e = rows_.begin[r]; e < rows_.begin[r + 1]; ++e) {
      const size_t slot = next[rows_.voxel[e]]++;
      by_voxel_row_[slot] = static_cast<int32_t>(r);
      by_voxel_coefficient_[slot] = rows_.coefficient[e];
    }
  row_products_.assign(rows_.size(), 0);
  BuildRightHandSide();
  BuildDiagonal();
}

void BandSystem::Differences(const std::vector<double>& phi) const {
  ParallelFor(band_.size(), kGrain, [&](size_t i) {
    std::array<float, 7>& d = differences_[i];
    double along_normal = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const int32_t minus = band_.Neighbor(i, axis, 0), plus = band_.Neighbor(i, axis, 1);
      const bool both = minus != Band::kNone && plus != Band::kNone;
      d[axis] = both ? static_cast<float>(phi[minus] - 2 * phi[i] + phi[plus]) : 0;
      if (interior_[i]) along_normal += 0.5 * weights_.n[i][axis] * (phi[plus] - phi[minus]);
    }
    for (int k = 0; k < 3; ++k) {
      const int32_t a = band_.Neighbor(i, kAxisA[k], 1), b = band_.Neighbor(i, kAxisB[k], 1);
      const int32_t ab = band_.Diagonal(i, kAxisA[k], 1, kAxisB[k], 1);
      const bool all = a != Band::kNone && b != Band::kNone && ab != Band::kNone;
      d[3 + k] = all ? kMixed * static_cast<float>(phi[i] + phi[ab] - phi[a] - phi[b]) : 0;
    }
    d[6] = static_cast<float>(along_normal);
  });
}

// Transposed differences at voxel i. A difference that was left out is zero, so it needs no test of its own.
double BandSystem::GatherDifferences(size_t i) const {
  const std::array<float, 7>& d = differences_[i];
  double smooth = -2.0 * (d[0] + d[1] + d[2]), along = 0;
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side) {
      const int32_t v = band_.Neighbor(i, axis, side);
      if (v == Band::kNone) continue;
      smooth += differences_[v][axis];
      along += (side ? -0.5 : 0.5) * weights_.n[v][axis] * differences_[v][6];
    }
  double mixed = d[3] + d[4] + d[5];
  for (int k = 0; k < 3; ++k) {
    const int32_t a = band_.Neighbor(i, kAxisA[k], 0), b = band_.Neighbor(i, kAxisB[k], 0);
    if (a != Band::kNone) mixed -= differences_[a][3 + k];
    if (b != Band::kNone) mixed -= differences_[b][3 + k];
    const int32_t ab = a == Band::kNone ? Band::kNone : band_.Neighbor(a, kAxisB[k], 0);
    if (ab != Band::kNone) mixed += differences_[ab][3 + k];
  }
  return weights_.smoothness * (smooth + kMixed * mixed) + weights_.normal * along;
}

void BandSystem::Apply(const std::vector<double>& phi, std::vector<double>& out) const {
  Differences(phi);
  ParallelFor(rows_.size(), 256, [&](size_t r) { row_products_[r] = rows_.weight[r] * rows_.Dot(r, phi); });
  out.resize(band_.size());
  ParallelFor(band_.size(), kGrain, [&](size_t i) {
    double value = GatherDifferences(i) + weights_.pull[i] * phi[i];
    for (size_t e = by_voxel_begin_[i]; e < by_voxel_begin_[i + 1]; ++e)
      value += by_voxel_coefficient_[e] * row_products_[by_voxel_row_[e]];
    out[i] = value;
  });
}

void BandSystem::BuildRightHandSide() {
  const float h = static_cast<float>(band_.voxel_size());
  for (size_t i = 0; i < band_.size(); ++i) {
    differences_[i].fill(0);
    differences_[i][6] = interior_[i] ? h : 0;  // the target of the normal derivative
  }
  rhs_.resize(band_.size());
  ParallelFor(band_.size(), kGrain, [&](size_t i) {
    double value = GatherDifferences(i) + static_cast<double>(weights_.pull[i]) * weights_.pull_target[i];
    for (size_t e = by_voxel_begin_[i]; e < by_voxel_begin_[i + 1]; ++e) {
      const int32_t r = by_voxel_row_[e];
      value += by_voxel_coefficient_[e] * rows_.weight[r] * rows_.target[r];
    }
    rhs_[i] = value;
  });
}

void BandSystem::BuildDiagonal() {
  inverse_diagonal_.resize(band_.size());
  ParallelFor(band_.size(), kGrain, [&](size_t i) {
    double smooth = 0, along = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const int32_t minus = band_.Neighbor(i, axis, 0), plus = band_.Neighbor(i, axis, 1);
      if (minus != Band::kNone && plus != Band::kNone) smooth += 4;
      for (int side = 0; side < 2; ++side) {
        const int32_t v = band_.Neighbor(i, axis, side);
        if (v == Band::kNone) continue;
        smooth += band_.Neighbor(v, axis, side) != Band::kNone;
        if (interior_[v]) along += 0.25 * weights_.n[v][axis] * weights_.n[v][axis];
      }
    }
    for (int k = 0; k < 3; ++k)
      for (int side_a = 0; side_a < 2; ++side_a)
        for (int side_b = 0; side_b < 2; ++side_b) {
          const bool all = band_.Diagonal(i, kAxisA[k], side_a, kAxisB[k], side_b) != Band::kNone &&
                           band_.Neighbor(i, kAxisB[k], side_b) != Band::kNone;
          if (all) smooth += 2;
        }
    double value = weights_.smoothness * smooth + weights_.normal * along + weights_.pull[i];
    for (size_t e = by_voxel_begin_[i]; e < by_voxel_begin_[i + 1]; ++e)
      value += by_voxel_coefficient_[e] * by_voxel_coefficient_[e] * rows_.weight[by_voxel_row_[e]];
    inverse_diagonal_[i] = value > 0 ? 1 / value : 0;
  });
}

double BandSystem::Energy(const std::vector<double>& phi) const {
  Differences(phi);
  const float h = static_cast<float>(band_.voxel_size());
  double energy = ParallelSum(band_.size(), kGrain, 0.0, [&](size_t begin, size_t end) {
    double sum = 0;
    for (size_t i = begin; i < end; ++i) {
      for (int k = 0; k < 6; ++k) sum += weights_.smoothness * differences_[i][k] * differences_[i][k];
      const double normal = interior_[i] ? differences_[i][6] - h : 0;
      const double pull = phi[i] - weights_.pull_target[i];
      sum += weights_.normal * normal * normal + weights_.pull[i] * pull * pull;
    }
    return sum;
  });
  for (size_t r = 0; r < rows_.size(); ++r) {
    const double residual = rows_.Dot(r, phi) - rows_.target[r];
    energy += rows_.weight[r] * residual * residual;
  }
  return energy;
}

SolveReport BandSystem::Solve(int max_iterations, double tolerance, std::vector<double>& phi) const {
  GLINT_CHECK_EQ(phi.size(), band_.size());
  SolveReport report;
  report.initial_energy = Energy(phi);
  const size_t n = phi.size();
  std::vector<double> r(n), z(n), p(n), q;
  Apply(phi, q);
  ParallelFor(n, kGrain, [&](size_t i) {
    r[i] = rhs_[i] - q[i];
    z[i] = inverse_diagonal_[i] * r[i];
    p[i] = z[i];
  });
  double rz = Dot(r, z);
  const double first = rz;
  while (report.iterations < max_iterations && rz > tolerance * tolerance * first && rz > 0) {
    Apply(p, q);
    const double pq = Dot(p, q);
    if (!(pq > 0)) break;  // the rest is in the null space, or rounding
    const double step = rz / pq;
    ParallelFor(n, kGrain, [&](size_t i) {
      phi[i] += step * p[i];
      r[i] -= step * q[i];
      z[i] = inverse_diagonal_[i] * r[i];
    });
    const double next = Dot(r, z);
    const double ratio = next / rz;
    ParallelFor(n, kGrain, [&](size_t i) { p[i] = z[i] + ratio * p[i]; });
    rz = next;
    ++report.iterations;
  }
  report.relative_residual = first > 0 ? std::sqrt(rz / first) : 0;
  report.final_energy = Energy(phi);
  return report;
}

}  // namespace glint
