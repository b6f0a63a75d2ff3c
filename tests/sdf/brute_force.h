// The slow truth: every triangle looked at in double, signs from the exact winding number.
#pragma once

#include <cmath>

#include "geometry/closest_point.h"
#include "geometry/winding_number.h"

namespace glint::testing {

inline double BruteDistance(const TriangleMesh& mesh, const Eigen::Vector3d& p) {
  double best = std::numeric_limits<double>::infinity();
  for (const Eigen::Vector3i& f : mesh.faces)
    best = std::min(
        best, ClosestOnTriangle(mesh.vertices[f[0]], mesh.vertices[f[1]], mesh.vertices[f[2]], p).squared_distance);
  return std::sqrt(best);
}

// Of a closed mesh; meaningless within rounding of the surface.
inline bool BruteInside(const TriangleMesh& mesh, const Eigen::Vector3d& p) {
  return std::lround(ExactWindingNumber(mesh, p)) > 0;
}

}  // namespace glint::testing
