// CGAL's Poisson reconstruction, as a measure for the seed.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "geometry/triangle_mesh.h"

namespace glint::benchmark {

// Normals from the neighbours' plane, turned to where each point is seen from (`toward`, a direction a point); then
// CGAL's poisson_surface_reconstruction_delaunay with its usual options. Empty if it fails.
TriangleMesh PoissonSurface(const std::vector<Eigen::Vector3d>& points, const std::vector<Eigen::Vector3d>& toward);

}  // namespace glint::benchmark
