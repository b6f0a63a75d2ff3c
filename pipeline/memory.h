// How much memory a run would need.
#pragma once

#include <cstdint>

#include "geometry/triangle_mesh.h"
#include "refine/refine.h"

namespace glint {

// Bytes that Refine() needs at its finest level, from the seed's area and the width of the band.
uint64_t EstimateRefineMemory(const TriangleMesh& seed, const RefineOptions& options);

// Throws InputError that says how much would be needed, how much there is and which voxel size would fit, unless
// the estimate is within `fraction` of the available memory.
void CheckRefineMemory(const TriangleMesh& seed, const RefineOptions& options, double fraction);

}  // namespace glint
