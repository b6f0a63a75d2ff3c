// How stiff a faired surface should be, by cross-validation.
#pragma once

#include <vector>

#include "geometry/triangle_mesh.h"
#include "seed/fair.h"

namespace glint {

// The smoothing for FairThroughPoints, from one to four times the options', which made `smooth`: many points that err a
// little must not dent the surface each. Fairs through three quarters of the sparse points and of those of outlines,
// and takes the stiffest that is no further off the rest than the best one, by the latter's standard error [Breiman,
// Friedman, Stone & Olshen 1984]; points and outlines, which carry the rims, both have to agree. The options' own where
// the points are too few to tell.
double SmoothingByHoldingOut(const TriangleMesh& smooth, const std::vector<Attachment>& attachments,
                             const FairContext& context, const FairOptions& options);

}  // namespace glint
