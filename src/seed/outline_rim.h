// What the smooth seed is too stiff for: edges and rims that the outlines show.
#pragma once

#include "colmap/scene.h"
#include "geometry/triangle_mesh.h"
#include "silhouette/silhouettes.h"

namespace glint {

// Where places on the outlines, well known along their rays, lie outside of the closed mesh, what the outlines of all
// views leave room for within `reach` of them. A closed mesh, to be joined to the other; empty if there are no such
// places. World units.
TriangleMesh MissingRim(const Scene& scene, const Silhouettes& silhouettes, const TriangleMesh& mesh, double reach,
                        double voxel);

// The closed mesh with it, as narrow as makes no tunnel, and smooth; as it is if nothing is missing.
TriangleMesh WithRim(const Scene& scene, const Silhouettes& silhouettes, const TriangleMesh& mesh, double voxel);

}  // namespace glint
