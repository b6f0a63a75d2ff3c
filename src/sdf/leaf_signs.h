// Inside and outside of all 8³ voxels of a leaf as bits: word x, bit y << 3 | z.
#pragma once

#include <array>
#include <cstdint>

namespace glint::internal {

using LeafBits = std::array<uint64_t, 8>;

// Sides of all voxels from those that are known: an unknown voxel is on the side of its neighbours, since between
// voxels on different sides one is closer to the surface than a voxel. At least one voxel must be known.
LeafBits SpreadSides(const LeafBits& known, const LeafBits& inside);

}  // namespace glint::internal
