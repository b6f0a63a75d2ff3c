// What the observations say about the cells of a triangulation: free space before a point, matter behind it.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "seed/tetrahedra.h"

namespace glint {

// One observation: the camera at `eye` sees the point.
struct SightLine {
  int point;
  Eigen::Vector3d eye;
};

// A line of sight that ends at a place that is no point of the triangulation: it only says what is free.
struct FreeLine {
  Eigen::Vector3d from;
  Eigen::Vector3d eye;
};

// Known matter: `depth` (world units) from the point along `direction` (unit).
struct MatterBehind {
  int point;
  Eigen::Vector3d direction;
  double depth;
};

// Votes are integers (kVote for one line) so that their sums do not depend on the order of adding.
inline constexpr int64_t kVote = 1024;

struct RayVotes {
  std::vector<int64_t> outside;                // per cell: cameras stand in it
  std::vector<int64_t> inside;                 // per cell: it lies just behind observed points
  std::vector<int64_t> crossed;                // per cell: lines that pass through it
  std::vector<std::array<int64_t, 4>> facets;  // per cell and facet: lines that leave the cell there, to the camera
};

// Labatut, Pons, Keriven 2007, section 3: a line adds to `facets` of all it crosses from its point to the camera,
// softly within `sigma` of the point (1 − exp(−t²/2σ²)), to `outside` of the camera's cell, and to `inside` of the cell
// 3 sigma behind the point. `sigma` per point, world units. Free lines have no `inside` and no softness.
RayVotes CastVotes(const Tetrahedra& tetrahedra, const std::vector<SightLine>& lines, const std::vector<double>& sigma,
                   const std::vector<FreeLine>& free_lines, const std::vector<MatterBehind>& matter = {});

}  // namespace glint
