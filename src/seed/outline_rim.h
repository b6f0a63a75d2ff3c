// What the smooth seed is too stiff for: edges and rims that the outlines show.
#pragma once

#include "colmap/scene.h"
#include "geometry/triangle_mesh.h"
#include "silhouette/silhouettes.h"

namespace glint {

// Where places on the outlines, well known along their rays, lie outside of the closed mesh, what the outlines of all
// views leave room for around them. A closed mesh, to be joined to the other; empty if there are no such places.
// `voxel`: world units.
TriangleMesh MissingRim(const Scene& scene, const Silhouettes& silhouettes, const TriangleMesh& mesh, double voxel);

}  // namespace glint
