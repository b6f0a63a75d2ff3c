// Two solids joined, or one without the other.
#pragma once

#include "geometry/triangle_mesh.h"

namespace glint {

// Of closed meshes that are oriented outward, on voxels of this size (world units): edges where their surfaces cross
// are rounded by about a voxel; those of the difference within `rounding_world` (up to three voxels) of both surfaces.
// Empty if nothing is left. Throw InputError as MeshToLevelSet does.
TriangleMesh Union(const TriangleMesh& a, const TriangleMesh& b, double voxel_size_world);
TriangleMesh Difference(const TriangleMesh& a, const TriangleMesh& b, double voxel_size_world,
                        double rounding_world = 0);

}  // namespace glint
