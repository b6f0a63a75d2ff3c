// The narrow band of a level set: what the energies and solvers work on.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "refine/band_topology.h"
#include "sdf/level_set.h"

namespace glint {

// Voxels of a level set's band in OpenVDB's leaf order.
class Band : public BandTopology {
 public:
  explicit Band(const LevelSet& level_set);

  double voxel_size() const { return voxel_size_; }  // world units
  double half_width_voxels() const { return half_width_voxels_; }

  // Signed distance at the voxels, world units, as the level set had it.
  const std::vector<float>& phi() const { return phi_; }

  Eigen::Vector3d ToIndexSpace(const Eigen::Vector3d& x_in_world) const { return (x_in_world - origin_) / voxel_size_; }
  Eigen::Vector3d Position(size_t i) const { return origin_ + voxel_size_ * Coord(i).cast<double>(); }

  // The eight voxels around a point and their trilinear weights. False if one of them is off the band.
  bool Trilinear(const Eigen::Vector3d& x_in_world, std::array<int32_t, 8>& voxels,
                 std::array<double, 8>& weights) const;

  // Calls with(voxel, squared distance in voxels) for the band's voxels within a ball.
  template <class With>
  void ForVoxelsInBall(const Eigen::Vector3d& x_in_world, double radius_voxels, const With& with) const {
    const Eigen::Vector3d center = ToIndexSpace(x_in_world);
    const Eigen::Vector3i low = (center.array() - radius_voxels).ceil().cast<int>();
    const Eigen::Vector3i high = (center.array() + radius_voxels).floor().cast<int>();
    for (int i = low[0]; i <= high[0]; ++i)
      for (int j = low[1]; j <= high[1]; ++j)
        for (int k = low[2]; k <= high[2]; ++k) {
          const double squared = (Eigen::Vector3d(i, j, k) - center).squaredNorm();
          if (squared > radius_voxels * radius_voxels) continue;
          const int32_t v = Find({i, j, k});
          if (v != kNone) with(v, squared);
        }
  }

  // A copy of the level set with other values at the voxels of the band (clamped to ± background).
  LevelSet WithValues(const std::vector<float>& phi) const;

 private:
  LevelSet source_;
  double voxel_size_;
  double half_width_voxels_;
  Eigen::Vector3d origin_;
  std::vector<float> phi_;
};

}  // namespace glint
