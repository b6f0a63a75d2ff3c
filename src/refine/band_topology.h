// Which voxels a band has and which are neighbours, as flat arrays.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

namespace glint {

// 36 bytes a voxel and the index tree.
class BandTopology {
 public:
  static constexpr int32_t kNone = -1;

  // Voxels are numbered in the order given, each once.
  explicit BandTopology(std::vector<Eigen::Vector3i> coords);
  ~BandTopology();
  BandTopology(BandTopology&&) noexcept;

  size_t size() const { return coords_.size(); }
  const Eigen::Vector3i& Coord(size_t i) const { return coords_[i]; }
  int32_t Find(const Eigen::Vector3i& ijk) const;  // kNone: not in the band

  // Face neighbour of voxel i along `axis` (0, 1, 2), side 0: minus, 1: plus. kNone off the band.
  int32_t Neighbor(size_t i, int axis, int side) const { return neighbors_[i][2 * axis + side]; }
  bool HasAllNeighbors(size_t i) const {
    return std::find(neighbors_[i].begin(), neighbors_[i].end(), kNone) == neighbors_[i].end();
  }
  // Neighbour at two steps along two axes; kNone if the first of them is off the band.
  int32_t Diagonal(size_t i, int axis_a, int side_a, int axis_b, int side_b) const {
    const int32_t a = Neighbor(i, axis_a, side_a);
    return a == kNone ? kNone : Neighbor(a, axis_b, side_b);
  }

 private:
  struct Index;
  std::unique_ptr<Index> index_;
  std::vector<Eigen::Vector3i> coords_;
  std::vector<std::array<int32_t, 6>> neighbors_;
};

}  // namespace glint
