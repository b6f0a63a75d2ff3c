// Triangle meshes of implicit shapes.
#pragma once

#include "geometry/triangle_mesh.h"
#include "synthetic/shapes.h"

namespace glint {

// Dual contouring (OpenVDB) on a grid with voxels of bounding diameter / `resolution`; every vertex is then moved onto
// the surface and given its normal. Closed, oriented outward.
TriangleMesh MeshShape(const ImplicitShape& shape, int resolution);

}  // namespace glint
