// Distance to the convex hull of points, without making the hull.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace glint {

// Whether x lies inside the convex hull of the points or no farther than `reach` from it (Gilbert 1966: the nearest
// point of the hull is approached by segments to the point that lies farthest towards x). Exact but for places within
// about a thousandth of the reach of the limit. False for no points.
bool NearConvexHull(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector3d& x, double reach);

}  // namespace glint
