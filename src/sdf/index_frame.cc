#include "sdf/index_frame.h"

#include <fmt/format.h>

#include <cmath>

#include "core/error.h"
#include "sdf/mesh_to_level_set.h"

namespace glint::internal {

double VoxelSizeOf(const Eigen::Affine3d& world_from_index) {
  const Eigen::Matrix3d m = world_from_index.linear();
  const double size = std::cbrt(m.determinant());
  if (!world_from_index.matrix().allFinite() || !(size > 0) || !(m.transpose() * m / (size * size)).isIdentity(1e-9))
    throw InputError("", "grid transform", "expected a rotation, a positive uniform scale and a translation");
  // OpenVDB takes transforms of a smaller determinant for singular.
  if (size < kSmallestVoxelWorld)
    throw InputError("", "voxel size",
                     fmt::format("expected at least {} (the smallest that OpenVDB can hold), found {}; "
                                 "scale the mesh up",
                                 kSmallestVoxelWorld, size));
  return size;
}

}  // namespace glint::internal
