// Which cells of a triangulation are matter: the minimum cut of Labatut, Pons, Keriven 2007.
#pragma once

#include <cstdint>
#include <vector>

#include "core/options.h"
#include "seed/ray_votes.h"
#include "seed/tetrahedra.h"

namespace glint {

struct CutOptions {
  double quality = 1.0;  // cost of a badly shaped facet, in lines of sight
  double fill = 0.5;     // claim of matter on a cell that no line of sight crosses, in lines of sight
  bool see_through = false;

  void Visit(OptionVisitor& v);
};

// Per cell: 1 inside, 0 outside. Infinite cells and those with may_be_inside = 0 are outside. The cost is
//   Σ lines that must cross the surface before their point + Σ lines without matter behind their point
//   + quality Σ_facets (1 − min(cos φ, cos ψ))      (φ, ψ: angles between facet and circumspheres, ibid. section 3.3)
//   + fill · (unseen cells outside), which keeps what nothing contradicts: the visibility-consistent hull
//   + claim · (all cells outside that may be inside), in lines of sight.
std::vector<uint8_t> CutCells(const Tetrahedra& tetrahedra, const RayVotes& votes,
                              const std::vector<uint8_t>& may_be_inside, const CutOptions& options, double claim = 0);

// Connected components (across facets) of the cells with label 1: per cell its component, −1 for the others.
struct CellComponents {
  std::vector<int> component;
  int count = 0;
};
CellComponents ConnectedCells(const Tetrahedra& tetrahedra, const std::vector<uint8_t>& labels);

}  // namespace glint
