// How much memory there is, and how much a run would need.
#pragma once

#include <cstdint>

#include "geometry/triangle_mesh.h"
#include "refine/refine.h"

namespace glint {

// Bytes that this process may still take: the least of what the machine has free, its control group's limit
// and its own address-space limit.
uint64_t AvailableMemory();

// Bytes that Refine() needs at its finest level, from the seed's area and the width of the band.
uint64_t EstimateRefineMemory(const TriangleMesh& seed, const RefineOptions& options);

// Throws InputError that says how much would be needed, how much there is and which voxel size would fit, unless
// the estimate is within `fraction` of the available memory.
void CheckRefineMemory(const TriangleMesh& seed, const RefineOptions& options, double fraction);

}  // namespace glint
