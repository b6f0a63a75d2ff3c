// Which triangles may be closest to some voxel of a tile, however far off they are.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "geometry/closest_point.h"

namespace glint::internal {

// Collects them for tiles of 8³ voxels of a mesh in index space. A point x of the mesh is never closest to any point p
// of a box with centre c and half sizes h if, q being the closest point to c,
// ‖p − x‖² − ‖p − q‖² = ‖x − c‖² − ‖q − c‖² − 2 (p − c)·(x − q) > 0 for all of them, that is if
// ‖x − c‖² − 2 ∑ hₖ |xₖ − qₖ| > ‖q − c‖²; the left side has its least value over a box of x axis by axis. Keeps a
// reference. Thread-safe.
class TileCandidates {
 public:
  explicit TileCandidates(const ClosestPointQuery& closest) : closest_(&closest) {}

  // The triangles in the order of the tree, those near but not in question among them. Gives the distance from the
  // tile's centre, which is at most `bound`.
  double Collect(const Eigen::Vector3i& origin, double bound, std::vector<uint32_t>& triangles) const;

 private:
  const ClosestPointQuery* closest_;
};

}  // namespace glint::internal
