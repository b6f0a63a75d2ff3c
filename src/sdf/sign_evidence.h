// Whether the signs of a narrow band can be those of a solid. Only for .cc files: it brings OpenVDB along.
#pragma once

#include <openvdb/openvdb.h>

#include <cstddef>

namespace glint::internal {

// Counts what cannot be: neighbouring voxels on different sides of which neither is near the surface (their distances
// sum to more than the voxel size), leaves that disagree with the tile beside them, and an inside that reaches
// infinity. None for a closed, consistently oriented mesh without self-intersections; self-intersections, and
// components that are inside out or inside others, are found out. The tree's tiles must be filled. Values in units of
// `voxel_size`.
size_t CountSignConflicts(const openvdb::FloatTree& tree, float voxel_size);

}  // namespace glint::internal
