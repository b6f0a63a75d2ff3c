// Which cells between the points are the object.
#pragma once

#include <cstdint>
#include <vector>

#include "seed/object_choice.h"
#include "seed/sparse_cells.h"
#include "seed/visibility_cut.h"

namespace glint {

// Per cell 1 where matter may be: above the ground, with at least one corner that is a point of the object or on its
// rim.
std::vector<uint8_t> Permitted(const SparseCells& cells, const ObjectChoice& choice);

// Keeps the largest piece of the cells with label 1 alone, so that the mesh is one object.
void KeepLargest(const Tetrahedra& tetrahedra, std::vector<uint8_t>& labels);

struct Solid {
  std::vector<uint8_t> labels;  // per cell: 1 matter
  double explained = 0;         // points of the object on its surface, and half of those within it
  double hidden = 0;            // points' lines of sight that end behind it
};

// The solid in one piece, without cavities, that explains most of the object's `num_points` points, of those that ever
// larger claims of matter give; a larger claim must explain many more.
Solid BestSolid(const SparseCells& cells, const ObjectChoice& choice, const CutOptions& options, double num_points,
                double views_per_point);

}  // namespace glint
