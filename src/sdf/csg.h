// Two solids joined, one without the other, one with its gaps filled.
#pragma once

#include "geometry/triangle_mesh.h"

namespace glint {

// Of closed meshes that are oriented outward, on voxels of this size (world units): edges where their surfaces cross
// are rounded by about a voxel; those of the difference within `rounding_world` (up to three voxels) of both surfaces.
// Empty if nothing is left. Throw InputError as MeshToLevelSet does.
TriangleMesh Union(const TriangleMesh& a, const TriangleMesh& b, double voxel_size_world);
TriangleMesh Difference(const TriangleMesh& a, const TriangleMesh& b, double voxel_size_world,
                        double rounding_world = 0);

// The solid with its gaps and tunnels filled as far as no ball of `radius_world` (up to four voxels) fits into them
// from outside: dilated, and eroded again.
TriangleMesh Closing(const TriangleMesh& mesh, double voxel_size_world, double radius_world);

}  // namespace glint
