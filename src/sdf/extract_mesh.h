// The mesh of an iso-surface of a level set.
#pragma once

#include "geometry/triangle_mesh.h"
#include "sdf/level_set.h"

namespace glint {

// The surface φ = iso_world, triangles oriented outward (towards larger φ), with unit vertex normals from the gradient
// of φ. OpenVDB's dual contouring gives the connectivity; every vertex is then moved onto the iso-surface of the
// tricubic field (trilinear at the rim of the band) by Newton steps along its gradient, which takes away the inward
// bias of averaged edge crossings: on a sphere of 20 voxels radius vertices are off by 0.0002 voxels instead of 0.02.
// Deterministic at any number of threads. Empty if no voxel lies on the far side of the level; |iso_world| must be
// below the half width of the band, else InputError.
TriangleMesh ExtractMesh(const LevelSet& level_set, double iso_world = 0);

}  // namespace glint
