#include "seed/convex_hull.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace glint {
namespace {

double Cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  return (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x();
}

}  // namespace

std::vector<Eigen::Vector2d> ConvexHull(std::vector<Eigen::Vector2d> points) {
  auto less = [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return std::pair(a.x(), a.y()) < std::pair(b.x(), b.y());
  };
  std::sort(points.begin(), points.end(), less);
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (points.size() < 3) return points;
  std::vector<Eigen::Vector2d> hull;
  for (int pass = 0; pass < 2; ++pass) {
    const size_t base = hull.size();
    for (const Eigen::Vector2d& p : points) {
      while (hull.size() >= base + 2 && Cross(hull[hull.size() - 2], hull.back(), p) <= 0) hull.pop_back();
      hull.push_back(p);
    }
    hull.pop_back();  // begins the other chain
    std::reverse(points.begin(), points.end());
  }
  return hull;
}

double DistanceToConvex(const std::vector<Eigen::Vector2d>& polygon, const Eigen::Vector2d& x) {
  double nearest = std::numeric_limits<double>::infinity();
  bool inside = polygon.size() >= 3;
  for (size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d& a = polygon[i];
    const Eigen::Vector2d& b = polygon[(i + 1) % polygon.size()];
    inside = inside && Cross(a, b, x) >= 0;
    const double length2 = (b - a).squaredNorm();
    const double t = length2 > 0 ? std::clamp((x - a).dot(b - a) / length2, 0.0, 1.0) : 0.0;
    nearest = std::min(nearest, (a + t * (b - a) - x).norm());
  }
  return inside ? 0 : nearest;
}

}  // namespace glint
