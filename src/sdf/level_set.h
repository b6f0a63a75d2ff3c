// A narrow-band signed distance field, in world units, on an OpenVDB grid that this header keeps out of sight.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <memory>

namespace glint {

struct LevelSetImpl;  // sdf/level_set_impl.h: holds the openvdb::FloatGrid

// Negative inside. Values in world units, class level set, background = half width of the band.
// Copies share the grid; DeepCopy() does not. Queries are thread-safe.
class LevelSet {
 public:
  LevelSet();  // empty
  explicit LevelSet(std::shared_ptr<LevelSetImpl> impl);

  bool empty() const;
  double voxel_size() const;         // world units
  double half_width_voxels() const;  // of the band
  size_t num_active_voxels() const;
  size_t memory_bytes() const;
  Eigen::AlignedBox3d ActiveBox() const;  // world

  // Trilinear value (world units; clamped to ± background off the band) and its gradient by central differences
  // of trilinear samples (≈ unit inside the band).
  double Value(const Eigen::Vector3d& x_in_world) const;
  Eigen::Vector3d Gradient(const Eigen::Vector3d& x_in_world) const;
  // The mean of Value over the next voxels, weighted 1 2 1 along each axis. Linear functions stay; what quadratic ones
  // shift by does not bend.
  double MeanValue(const Eigen::Vector3d& x_in_world) const;

  LevelSet DeepCopy() const;
  const LevelSetImpl& impl() const { return *impl_; }
  LevelSetImpl& impl() { return *impl_; }

 private:
  std::shared_ptr<LevelSetImpl> impl_;
};

}  // namespace glint
