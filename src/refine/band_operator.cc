#include "refine/band_operator.h"

#include <array>
#include <cmath>
#include <utility>

#include "core/check.h"
#include "core/parallel.h"
#include "core/random_bits.h"

namespace glint {
namespace {

constexpr size_t kGrain = 1 << 13;
constexpr size_t kCrowd = 4;                                 // rows a voxel
constexpr int kAxisA[3] = {0, 0, 1}, kAxisB[3] = {1, 2, 2};  // of the three mixed differences
constexpr float kMixed = static_cast<float>(M_SQRT2);        // ‖H‖² counts each mixed derivative twice
constexpr int32_t kNone = BandTopology::kNone;

float Sign(uint64_t bits, int k) { return (bits >> k & 1) != 0 ? 1.0f : -1.0f; }

// Of a set of differences: 1 for those in it.
constexpr std::array<std::array<float, 8>, 128> MakeFlags() {
  std::array<std::array<float, 8>, 128> flags{};
  for (int set = 0; set < 128; ++set)
    for (int k = 0; k < 7; ++k) flags[set][k] = static_cast<float>(set >> k & 1);
  return flags;
}
constexpr auto kFlags = MakeFlags();

}  // namespace

BandOperator::BandOperator(const BandTopology& topology, const BandWeights& weights, BandRows rows)
    : topology_(topology),
      weights_(weights),
      rows_(std::move(rows)),
      interior_(topology.size()),
      present_(topology.size()),
      crowded_(rows_.size() > kCrowd * topology.size()),
      weighted_(topology.size() + 1),
      row_products_(rows_.size()) {
  const size_t n = topology.size();
  neighbors_with_.resize(n);
  GLINT_CHECK_EQ(weights_.n.size(), n);
  GLINT_CHECK_EQ(weights_.pull.size(), n);
  ParallelFor(n, kGrain, [&](size_t i) {
    interior_[i] = topology.HasAllNeighbors(i);
    if (interior_[i]) present_[i] |= 1 << 6;
    for (int axis = 0; axis < 3; ++axis)
      if (topology.Neighbor(i, axis, 0) != kNone && topology.Neighbor(i, axis, 1) != kNone) present_[i] |= 1 << axis;
    for (int k = 0; k < 3; ++k)
      if (topology.Neighbor(i, kAxisB[k], 1) != kNone && topology.Diagonal(i, kAxisA[k], 1, kAxisB[k], 1) != kNone)
        present_[i] |= 8 << k;
  });
  ParallelFor(n, kGrain, [&](size_t i) {
    for (int side = 0; side < 6; ++side) {
      const int32_t v = topology.Neighbor(i, side / 2, side % 2);
      for (int k = 0; v != kNone && k < 6; ++k) neighbors_with_[i][k] += present_[v] >> k & 1;
    }
  });
  by_voxel_begin_.assign(n + 1, 0);
  for (int32_t v : rows_.voxel) ++by_voxel_begin_[v + 1];
  for (size_t i = 0; i < n; ++i) by_voxel_begin_[i + 1] += by_voxel_begin_[i];
  by_voxel_row_.resize(rows_.voxel.size());
  by_voxel_coefficient_.resize(rows_.voxel.size());
  std::vector<size_t> next(by_voxel_begin_.begin(), by_voxel_begin_.end() - 1);
  for (size_t r = 0; r < rows_.size(); ++r)
    for (size_t e = rows_.begin[r]; e < rows_.begin[r + 1]; ++e) {
      const size_t slot = next[rows_.voxel[e]]++;
      by_voxel_row_[slot] = static_cast<int32_t>(r);
      by_voxel_coefficient_[slot] = rows_.coefficient[e];
    }
}

// Without branches: what is not there is read at the voxel itself and then multiplied by zero.
template <class T>
void BandOperator::TakeDifferences(const std::vector<T>& phi, std::vector<Differences>& differences) const {
  const size_t n = topology_.size();
  differences.resize(n + 1);
  differences[n] = {};
  ParallelFor(n, kGrain, [&](size_t i) {
    const int32_t self = static_cast<int32_t>(i);
    const auto or_self = [self](int32_t v) { return v < 0 ? self : v; };
    const auto& flag = kFlags[present_[i]];
    const T here = phi[i];
    std::array<int32_t, 3> next;
    std::array<T, 3> ahead;
    Differences& d = differences[i];  // in place: what is put together elsewhere and copied costs twice as much
    T along_normal = 0;
    for (int axis = 0; axis < 3; ++axis) {
      next[axis] = or_self(topology_.Neighbor(i, axis, 1));
      ahead[axis] = phi[next[axis]];
      const T minus = phi[or_self(topology_.Neighbor(i, axis, 0))];
      d[axis] = flag[axis] * static_cast<float>(minus - 2 * here + ahead[axis]);
      along_normal += T(0.5) * weights_.n[i][axis] * (ahead[axis] - minus);
    }
    for (int k = 0; k < 3; ++k) {
      const int32_t ab = or_self(topology_.Neighbor(next[kAxisA[k]], kAxisB[k], 1));
      d[3 + k] = flag[3 + k] * kMixed * static_cast<float>(here + phi[ab] - ahead[kAxisA[k]] - ahead[kAxisB[k]]);
    }
    d[6] = flag[6] * static_cast<float>(along_normal);
    d[7] = 0;
  });
}

template void BandOperator::TakeDifferences(const std::vector<float>&, std::vector<Differences>&) const;
template void BandOperator::TakeDifferences(const std::vector<double>&, std::vector<Differences>&) const;

void BandOperator::WeighDifferences(const std::vector<Differences>& differences,
                                    std::vector<Weighted>& weighted) const {
  const float smoothness = static_cast<float>(weights_.smoothness), normal = static_cast<float>(weights_.normal);
  const float change = static_cast<float>(weights_.bend_change);
  weighted[0] = {};
  const size_t n = topology_.size();
  const auto vector = [&](const Differences& d) { return Eigen::Map<const Eigen::Array<float, 8, 1>>(d.data()); };
  ParallelFor(n, kGrain, [&](size_t i) {
    const auto d = vector(differences[i]);
    Differences w;
    Eigen::Map<Eigen::Array<float, 8, 1>> sum(w.data());
    sum = smoothness * d;
    if (change > 0) {
      // Differences that are not there are zero, so that only how many of the neighbours have one needs counting.
      Eigen::Array<float, 8, 1> around = Eigen::Array<float, 8, 1>::Zero();
      for (int side = 0; side < 6; ++side) {
        const int32_t v = topology_.Neighbor(i, side / 2, side % 2);
        around += vector(differences[v < 0 ? n : static_cast<size_t>(v)]);
      }
      const auto count = Eigen::Map<const Eigen::Array<uint8_t, 8, 1>>(neighbors_with_[i].data()).cast<float>();
      sum += change * (count * d - vector(kFlags[present_[i]]) * around);
    }
    LayOut(w, normal * d[6], i, weighted[i + 1]);
  });
}

void BandOperator::LayOut(const Differences& weighted_bends, float weighted_normal, size_t i, Weighted& out) const {
  for (int axis = 0; axis < 3; ++axis) {
    const float along = 0.5f * weights_.n[i][axis] * weighted_normal;
    out.from_minus[axis] = weighted_bends[axis] - along;
    out.from_plus[axis] = weighted_bends[axis] + along;
    out.mixed[axis] = kMixed * weighted_bends[3 + axis];
  }
}

void BandOperator::WeighNoise(uint64_t seed, std::vector<Weighted>& weighted) const {
  const float smoothness = std::sqrt(static_cast<float>(weights_.smoothness));
  const float change = std::sqrt(static_cast<float>(weights_.bend_change));
  const float normal = std::sqrt(static_cast<float>(weights_.normal));
  weighted[0] = {};
  ParallelFor(topology_.size(), kGrain, [&](size_t i) {
    const uint64_t bits = RandomBits(seed, i);
    const auto& flag = kFlags[present_[i]];
    Differences w{};
    for (int k = 0; k < 6; ++k) w[k] = smoothness * flag[k] * Sign(bits, k);
    for (int axis = 0; axis < 3; ++axis)
      for (int side = 0; side < 2; ++side) {
        const int32_t v = topology_.Neighbor(i, axis, side);
        if (v == kNone) continue;
        // The pair's signs are those of its voxel on the minus side.
        const uint64_t pair = side == 1 ? bits : RandomBits(seed, static_cast<size_t>(v));
        const auto& both = kFlags[present_[i] & present_[v]];
        for (int k = 0; k < 6; ++k) w[k] += (side == 1 ? change : -change) * both[k] * Sign(pair, 6 * (axis + 1) + k);
      }
    LayOut(w, normal * flag[6] * Sign(bits, 24), i, weighted[i + 1]);
  });
}

double BandOperator::DifferencesEnergy(const std::vector<Differences>& differences, size_t begin, size_t end) const {
  double energy = 0;
  for (size_t i = begin; i < end; ++i) {
    const Differences& d = differences[i];
    for (int k = 0; k < 6; ++k) energy += weights_.smoothness * d[k] * d[k];
    energy += weights_.normal * d[6] * d[6];
    for (int axis = 0; axis < 3; ++axis) {
      const int32_t v = topology_.Neighbor(i, axis, 1);
      if (v == kNone) continue;
      for (int k = 0; k < 6; ++k)
        if ((present_[i] & present_[v]) >> k & 1)
          energy += weights_.bend_change * (d[k] - differences[v][k]) * (d[k] - differences[v][k]);
    }
  }
  return energy;
}

float BandOperator::GatherDifferences(const std::vector<Weighted>& weighted, size_t i) const {
  const Weighted& here = weighted[i + 1];
  std::array<int32_t, 3> before;
  float sum = here.mixed[0] + here.mixed[1] + here.mixed[2];
  for (int axis = 0; axis < 3; ++axis) {
    before[axis] = topology_.Neighbor(i, axis, 0);
    sum += weighted[topology_.Neighbor(i, axis, 1) + 1].from_minus[axis] + weighted[before[axis] + 1].from_plus[axis] -
           here.from_minus[axis] - here.from_plus[axis];
  }
  for (int k = 0; k < 3; ++k) {
    const int32_t a = before[kAxisA[k]], b = before[kAxisB[k]];
    const int32_t ab = a < 0 ? kNone : topology_.Neighbor(a, kAxisB[k], 0);
    sum += weighted[ab + 1].mixed[k] - weighted[a + 1].mixed[k] - weighted[b + 1].mixed[k];
  }
  return sum;
}

double BandOperator::GatherRows(const std::vector<double>& row_values, size_t i) const {
  double value = 0;
  for (size_t e = by_voxel_begin_[i]; e < by_voxel_begin_[i + 1]; ++e)
    value += by_voxel_coefficient_[e] * row_values[by_voxel_row_[e]];
  return value;
}

RowGram BandOperator::MultipliedOut() const {
  return RowGram::Make(topology_.size(), topology_.size(), [&](size_t i, const auto& add) {
    for (size_t e = by_voxel_begin_[i]; e < by_voxel_begin_[i + 1]; ++e) {
      const auto r = static_cast<size_t>(by_voxel_row_[e]);
      const double weighted = rows_.weight[r] * by_voxel_coefficient_[e];
      for (size_t k = rows_.begin[r]; k < rows_.begin[r + 1]; ++k) add(rows_.voxel[k], weighted * rows_.coefficient[k]);
    }
  });
}

const RowGram& BandOperator::Gram() const {
  GLINT_CHECK(crowded_);
  if (!gram_) gram_ = MultipliedOut();
  return *gram_;
}

template <class T>
void BandOperator::Apply(const std::vector<T>& phi, std::vector<T>& out) const {
  TakeDifferences(phi, differences_);
  WeighDifferences(differences_, weighted_);
  const RowGram* const gram = Crowded() ? &Gram() : nullptr;
  if (!gram) ParallelFor(rows_.size(), 256, [&](size_t r) { row_products_[r] = rows_.weight[r] * rows_.Dot(r, phi); });
  out.resize(topology_.size());
  ParallelFor(topology_.size(), kGrain, [&](size_t i) {
    const double of_rows = gram ? gram->Product(i, phi) : GatherRows(row_products_, i);
    out[i] = static_cast<T>(GatherDifferences(weighted_, i) + weights_.pull[i] * phi[i] + of_rows);
  });
}

template void BandOperator::Apply(const std::vector<float>&, std::vector<float>&) const;
template void BandOperator::Apply(const std::vector<double>&, std::vector<double>&) const;

// Of a difference with coefficients c, voxel i bears |c_i| Σ|c|; differences of those at most twelve times that.
double BandOperator::AbsoluteRowSum(size_t i, const std::vector<double>& row_sums) const {
  double smooth = 0, along = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const int32_t minus = topology_.Neighbor(i, axis, 0), plus = topology_.Neighbor(i, axis, 1);
    if (minus != kNone && plus != kNone) smooth += 8;
    for (int side = 0; side < 2; ++side) {
      const int32_t v = topology_.Neighbor(i, axis, side);
      if (v == kNone) continue;
      if (topology_.Neighbor(v, axis, side) != kNone) smooth += 4;
      if (interior_[v]) along += 0.5 * std::abs(weights_.n[v][axis]) * weights_.n[v].lpNorm<1>();
    }
  }
  for (int k = 0; k < 3; ++k)
    for (int side_a = 0; side_a < 2; ++side_a)
      for (int side_b = 0; side_b < 2; ++side_b) {
        const bool all = topology_.Diagonal(i, kAxisA[k], side_a, kAxisB[k], side_b) != kNone &&
                         topology_.Neighbor(i, kAxisB[k], side_b) != kNone;
        if (all) smooth += 8;
      }
  double value =
      (weights_.smoothness + 12 * weights_.bend_change) * smooth + weights_.normal * along + weights_.pull[i];
  if (Crowded()) return value + gram_->AbsoluteSum(i);
  for (size_t e = by_voxel_begin_[i]; e < by_voxel_begin_[i + 1]; ++e)
    value += std::abs(by_voxel_coefficient_[e]) * row_sums[by_voxel_row_[e]];
  return value;
}

std::vector<float> BandOperator::InverseAbsoluteRowSums() const {
  std::vector<double> row_sums(rows_.size(), 0);
  if (Crowded()) Gram();
  for (size_t r = 0; r < rows_.size() && !Crowded(); ++r) {
    for (size_t e = rows_.begin[r]; e < rows_.begin[r + 1]; ++e) row_sums[r] += std::abs(rows_.coefficient[e]);
    row_sums[r] *= rows_.weight[r];
  }
  std::vector<float> inverse(topology_.size());
  ParallelFor(inverse.size(), kGrain, [&](size_t i) {
    const double sum = AbsoluteRowSum(i, row_sums);
    inverse[i] = sum > 0 ? static_cast<float>(1 / sum) : 0;
  });
  return inverse;
}

}  // namespace glint
