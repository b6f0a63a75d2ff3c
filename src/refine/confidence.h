// How sure the surface is, a vertex.
#pragma once

#include "geometry/triangle_mesh.h"
#include "refine/posterior.h"

namespace glint {

// Adds to `mesh` (in units of the object's diagonal) the scalars `sigma_position_rel` and `sigma_normal_deg`, and
// `confidence`, which is 1 where the normal is known exactly and 1/2 where it is known to 5 degrees.
void AddConfidence(const SurfaceDeviation& deviation, TriangleMesh& mesh);

}  // namespace glint
