#include "geometry/convex_distance.h"

#include <algorithm>

namespace glint {
namespace {

constexpr int kMostSteps = 1000;
constexpr double kTolerance = 1e-3;  // of the reach

}  // namespace

bool NearConvexHull(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector3d& x, double reach) {
  if (points.empty()) return false;
  Eigen::Vector3d nearest = points.front() - x;  // of the hull so far, seen from x
  for (int step = 0; step < kMostSteps; ++step) {
    const double distance = nearest.norm();
    if (distance <= reach) return true;
    const auto farthest = std::min_element(
        points.begin(), points.end(), [&](const auto& a, const auto& b) { return nearest.dot(a) < nearest.dot(b); });
    const Eigen::Vector3d towards = *farthest - x;
    // The plane through it across `nearest` has the whole hull behind it.
    if (nearest.dot(towards) > reach * distance) return false;
    const Eigen::Vector3d way = towards - nearest;
    const double t = std::clamp(-nearest.dot(way) / std::max(way.squaredNorm(), 1e-300), 0.0, 1.0);
    nearest += t * way;
    if (distance - nearest.norm() < kTolerance * kTolerance * reach) break;
  }
  return nearest.norm() <= (1 + kTolerance) * reach;
}

}  // namespace glint
