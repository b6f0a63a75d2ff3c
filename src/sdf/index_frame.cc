#include "sdf/index_frame.h"

#include <cmath>

#include "core/error.h"

namespace glint::internal {

double VoxelSizeOf(const Eigen::Affine3d& world_from_index) {
  const Eigen::Matrix3d m = world_from_index.linear();
  const double size = std::cbrt(m.determinant());
  if (!world_from_index.matrix().allFinite() || !(size > 0) || !(m.transpose() * m / (size * size)).isIdentity(1e-9))
    throw InputError("", "grid transform", "expected a rotation, a positive uniform scale and a translation");
  return size;
}

}  // namespace glint::internal
