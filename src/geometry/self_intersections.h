// Pairs of faces that pass through each other.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "geometry/triangle_mesh.h"

namespace glint {

// Pairs (lower, higher face) that meet elsewhere than in the vertices and edges they share by index, in order; decided
// with exact predicates. Faces without area are left out, and so are pairs that share all three vertices. At most
// `limit` pairs are returned (the lowest ones). The mesh must be welded (geometry/clean_mesh.h).
std::vector<std::array<uint32_t, 2>> SelfIntersections(const TriangleMesh& mesh, size_t limit = 1 << 24);

}  // namespace glint
