// The mesh of a level of any sampled field.
#pragma once

#include "geometry/triangle_mesh.h"
#include "sdf/dense_distance.h"

namespace glint {

// Where the field passes `iso`, oriented towards its larger values; closed where the outermost samples are above it.
// Without normals. Samples lie at world_from_index * (x, y, z).
TriangleMesh MeshOfField(const DenseField& field, const Eigen::Affine3d& world_from_index, double iso);

}  // namespace glint
