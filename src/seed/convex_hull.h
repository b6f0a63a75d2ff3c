// Convex polygons in the plane.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace glint {

// Corners of the convex hull, counter-clockwise, without collinear ones (Andrew's monotone chain).
std::vector<Eigen::Vector2d> ConvexHull(std::vector<Eigen::Vector2d> points);

// Distance of x from the convex polygon: 0 inside; infinite for an empty one. Two corners are a segment, one a point.
double DistanceToConvex(const std::vector<Eigen::Vector2d>& polygon, const Eigen::Vector2d& x);

}  // namespace glint
