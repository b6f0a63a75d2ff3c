// The border of a set of cells as a closed, oriented, manifold mesh.
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/triangle_mesh.h"
#include "seed/tetrahedra.h"

namespace glint {

// Facets between cells of label 1 and 0, counter-clockwise from outside. Where the border touches itself along an edge
// or in a point, its sheets are separated: facets are joined around an edge through the inside, so every edge has
// exactly two faces and every vertex one fan. Separated copies of a vertex have the same position. `vertex_point`
// (optional) receives the triangulation's point of every vertex, −1 for one in the middle of an edge.
TriangleMesh CellSurface(const Tetrahedra& tetrahedra, const std::vector<uint8_t>& labels,
                         std::vector<int>* vertex_point = nullptr);

}  // namespace glint
