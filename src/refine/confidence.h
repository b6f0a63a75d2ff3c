// How sure the surface is, a vertex.
#pragma once

#include <vector>

#include "geometry/triangle_mesh.h"
#include "refine/bundle.h"
#include "refine/level_set_step.h"

namespace glint {

// Adds to `mesh` (in units of the object's diagonal) `confidence` and the scalars `sigma_position_rel` and
// `sigma_normal_deg`. A contact or point vouches for its surroundings with a variance that grows with the distance.
void AddConfidence(const std::vector<OrientedPoint>& contacts, const std::vector<SurfacePoint>& points,
                   double seed_sigma_rel, TriangleMesh& mesh);

}  // namespace glint
