// Between a band and one of twice the voxel size.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "refine/band_rows.h"
#include "refine/band_topology.h"

namespace glint {

// A fine voxel takes 3/4 of its parent and 1/4 of the parent's neighbour on its own side, along each axis: the
// refinement of a quadratic B-spline.
class BandTransfer {
 public:
  explicit BandTransfer(const BandTopology& fine);

  const BandTopology& coarse() const { return coarse_; }

  void AddProlonged(const std::vector<float>& coarse, std::vector<float>& fine) const;  // fine += P coarse
  void Restrict(const std::vector<float>& fine, std::vector<float>& coarse) const;      // coarse = Pᵀ fine
  BandRows Restrict(const BandRows& fine) const;                                        // rows · P
  // visit(voxel, weight) for the parents of a fine voxel, and for the children of a coarse one.
  template <class Visit>
  void ForParents(size_t fine, const Visit& visit) const {
    for (unsigned bits = 0; bits < 8; ++bits) visit(parents_[fine][bits], kWeight[std::popcount(bits)]);
  }
  template <class Visit>
  void ForChildren(size_t coarse, const Visit& visit) const {
    for (size_t e = begin_[coarse]; e < begin_[coarse + 1]; ++e)
      visit(static_cast<size_t>(children_[e] & kIndexMask), kWeight[children_[e] >> 30]);
  }
  // Of each coarse voxel's children, the mean; unit length.
  std::vector<Eigen::Vector3f> MeanNormals(const std::vector<Eigen::Vector3f>& fine) const;

 private:
  static constexpr uint32_t kIndexMask = (1u << 30) - 1;
  static constexpr float kWeight[4] = {27.f / 64, 9.f / 64, 3.f / 64, 1.f / 64};  // by the number of quarters

  BandTopology coarse_;
  std::vector<std::array<int32_t, 8>> parents_;  // of a fine voxel: bit k set: the neighbour along axis k
  // The transposed: fine voxel, and in the top two bits how many of its weights are 1/4.
  std::vector<size_t> begin_;
  std::vector<uint32_t> children_;
};

}  // namespace glint
