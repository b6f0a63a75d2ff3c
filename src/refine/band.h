// The narrow band as flat arrays: what the level-set energies and solvers work on.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "sdf/level_set.h"

namespace glint {

// Voxels of a level set's band in a fixed order (OpenVDB's leaf order), with their six face neighbours.
// 40 bytes a voxel and the index grid.
class Band {
 public:
  static constexpr int32_t kNone = -1;

  explicit Band(const LevelSet& level_set);
  ~Band();

  size_t size() const { return phi_.size(); }
  double voxel_size() const { return voxel_size_; }  // world units
  double half_width_voxels() const { return half_width_voxels_; }

  // Signed distance at the voxels, world units, as the level set had it.
  const std::vector<float>& phi() const { return phi_; }

  // Face neighbour of voxel i along `axis` (0, 1, 2), side 0: minus, 1: plus. kNone off the band.
  int32_t Neighbor(size_t i, int axis, int side) const { return neighbors_[i][2 * axis + side]; }
  bool HasAllNeighbors(size_t i) const {
    return std::find(neighbors_[i].begin(), neighbors_[i].end(), kNone) == neighbors_[i].end();
  }
  // Neighbour at two steps along two axes; kNone if the corner or both ways to it are off the band.
  int32_t Diagonal(size_t i, int axis_a, int side_a, int axis_b, int side_b) const {
    const int32_t a = Neighbor(i, axis_a, side_a);
    return a == kNone ? kNone : Neighbor(a, axis_b, side_b);
  }

  int32_t Find(const Eigen::Vector3i& ijk) const;
  Eigen::Vector3d ToIndexSpace(const Eigen::Vector3d& x_in_world) const { return (x_in_world - origin_) / voxel_size_; }
  Eigen::Vector3d Position(size_t i) const { return origin_ + voxel_size_ * coords_[i].cast<double>(); }
  const Eigen::Vector3i& Coord(size_t i) const { return coords_[i]; }

  // The eight voxels around a point and their trilinear weights. False if one of them is off the band.
  bool Trilinear(const Eigen::Vector3d& x_in_world, std::array<int32_t, 8>& voxels,
                 std::array<double, 8>& weights) const;

  // A copy of the level set with other values at the voxels of the band (clamped to ± background).
  LevelSet WithValues(const std::vector<float>& phi) const;

 private:
  struct Index;
  LevelSet source_;
  std::unique_ptr<Index> index_;
  double voxel_size_;
  double half_width_voxels_;
  Eigen::Vector3d origin_;
  std::vector<float> phi_;
  std::vector<Eigen::Vector3i> coords_;
  std::vector<std::array<int32_t, 6>> neighbors_;
};

}  // namespace glint
