// The matrix of a least-squares problem over the voxels of a band, never stored: second differences, the derivative
// along the surface's normal, a pull at every voxel, and sparse rows.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "refine/band_rows.h"
#include "refine/band_topology.h"
#include "refine/row_gram.h"

namespace glint {

// Weights of the terms that every voxel has.
struct BandWeights {
  double smoothness = 1;   // of ‖h² H(φ − reference)‖², second differences; mixed ones at the faces' centres
  double bend_change = 0;  // of ‖h³ ∇H(φ − reference)‖², differences of those between neighbours
  std::vector<float> reference;    // what costs no bending, a voxel; NaN: unknown there; empty: zero everywhere
  double normal = 0;               // of (h ∂φ/∂n − h)², which keeps |∇φ| near 1
  std::vector<Eigen::Vector3f> n;  // unit normals of the current surface, a voxel
  std::vector<float> pull;         // of (φ − pull_target)², a voxel
  std::vector<float> pull_target;
};

// A difference that needs a voxel off the band is left out: natural boundary conditions.
// Work: about 250 flops a voxel and product, and those of the rows, but where they crowd; memory 81 bytes a voxel.
class BandOperator {
 public:
  // Three second differences, three mixed ones (times √2), the derivative along n, all times powers of h; and a zero,
  // for vectors of eight.
  using Differences = std::array<float, 8>;

  // Keeps references to `topology` and `weights`.
  BandOperator(const BandTopology& topology, const BandWeights& weights, BandRows rows);

  const BandTopology& topology() const { return topology_; }
  const BandWeights& weights() const { return weights_; }
  const BandRows& rows() const { return rows_; }
  bool Interior(size_t i) const { return interior_[i]; }  // all six neighbours are in the band

  void SetRowWeights(const std::vector<double>& weight) {
    rows_.weight = weight;
    if (Crowded()) gram_.reset();
  }

  // Whether there are so many rows that they are multiplied out once instead of for every product.
  bool Crowded() const { return crowded_; }
  // The rows multiplied out; of a crowded band. Not for two threads at once.
  const RowGram& Gram() const;
  // In place of rows, of which there are none.
  void SetGram(RowGram gram) {
    crowded_ = true;
    gram_ = std::move(gram);
  }

  // out = matrix · phi, for float and double. Not for two threads at once.
  template <class T>
  void Apply(const std::vector<T>& phi, std::vector<T>& out) const;

  // The matrix itself, for small bands.
  Eigen::MatrixXf Dense() const;

  // One more than voxels: the last are those of the voxel that is not there, zeros.
  template <class T>
  void TakeDifferences(const std::vector<T>& phi, std::vector<Differences>& differences) const;
  // What the transposed differences are taken of: each difference times its weights, laid out by who needs it. Slot 0
  // is the voxel that is not there.
  struct Weighted {
    std::array<float, 3> from_minus, from_plus;  // for the neighbour on the minus, on the plus side of each axis
    std::array<float, 3> mixed;
  };
  void WeighDifferences(const std::vector<Differences>& differences, std::vector<Weighted>& weighted) const;
  // The same of noise: of every difference an independent ±1 times the square root of its weight, so that what is then
  // gathered has the covariance of the differences' part of the matrix. Which signs, `seed` decides.
  void WeighNoise(uint64_t seed, std::vector<Weighted>& weighted) const;
  // Transposed differences at voxel i.
  float GatherDifferences(const std::vector<Weighted>& weighted, size_t i) const;
  // Σ weight · difference² over voxels [begin, end); differences[6] is less its target.
  double DifferencesEnergy(const std::vector<Differences>& differences, size_t begin, size_t end) const;
  // Transposed rows at voxel i, of a value a row.
  double GatherRows(const std::vector<double>& row_values, size_t i) const;

  // 1 / Σ_j |A_ij|: scaled by it, no eigenvalue of the matrix is above 1.
  std::vector<float> InverseAbsoluteRowSums() const;

 private:
  void LayOut(const Differences& weighted_bends, float weighted_normal, size_t i, Weighted& out) const;
  RowGram MultipliedOut() const;
  double AbsoluteRowSum(size_t i, const std::vector<double>& row_sums) const;

  const BandTopology& topology_;
  const BandWeights& weights_;
  BandRows rows_;
  std::vector<uint8_t> interior_;
  std::vector<uint8_t> present_;                        // bit k: difference k has all its voxels
  std::vector<std::array<uint8_t, 8>> neighbors_with_;  // of the six, how many have difference k; of k < 6
  // Rows by voxel, so that their transposed product is a gather.
  std::vector<size_t> by_voxel_begin_;
  std::vector<int32_t> by_voxel_row_;
  std::vector<float> by_voxel_coefficient_;
  bool crowded_;
  mutable std::optional<RowGram> gram_;           // made when it is asked for
  mutable std::vector<Differences> differences_;  // scratch of Apply
  mutable std::vector<Weighted> weighted_;
  mutable std::vector<double> row_products_;
};

}  // namespace glint
