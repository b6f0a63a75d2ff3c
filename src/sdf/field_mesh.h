// The mesh of a level of any sampled field.
#pragma once

#include <Eigen/Geometry>
#include <functional>

#include "geometry/triangle_mesh.h"
#include "sdf/dense_distance.h"

namespace glint {

// Where the field passes `iso`, oriented towards its larger values; closed where the outermost samples are above it.
// Without normals. Samples lie at world_from_index * (x, y, z).
TriangleMesh MeshOfField(const DenseField& field, const Eigen::Affine3d& world_from_index, double iso);

// The same of the zero level of a function of places in the world, sampled at origin + voxel * (x, y, z), `size` of
// them along each axis. `value` is asked from several threads.
TriangleMesh MeshOfFunction(const Eigen::Vector3d& origin, double voxel, const Eigen::Vector3i& size,
                            const std::function<double(const Eigen::Vector3d&)>& value);

}  // namespace glint
