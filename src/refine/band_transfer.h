// Between a band and one of twice the voxel size.
#pragma once

#include <array>
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
  // Of each coarse voxel's children, the mean; unit length.
  std::vector<Eigen::Vector3f> MeanNormals(const std::vector<Eigen::Vector3f>& fine) const;

 private:
  BandTopology coarse_;
  std::vector<std::array<int32_t, 8>> parents_;  // of a fine voxel: bit k set: the neighbour along axis k
  // The transposed: fine voxel, and in the top two bits how many of its weights are 1/4.
  std::vector<size_t> begin_;
  std::vector<uint32_t> children_;
};

}  // namespace glint
