// The frames that grids may have.
#pragma once

#include <Eigen/Geometry>

namespace glint::internal {

// The edge length of the voxels. Throws InputError unless the transform is a rotation, a positive uniform scale and a
// translation.
double VoxelSizeOf(const Eigen::Affine3d& world_from_index);

}  // namespace glint::internal
