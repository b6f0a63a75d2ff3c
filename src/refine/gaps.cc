#include "refine/gaps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <set>

namespace glint {
namespace {

// What lies across a wall or around a rim says nothing of this side: 60 degrees.
constexpr double kWidest = M_PI / 3;
constexpr double kSlack = 1e-9;  // radians, for rounding
constexpr double kCell = 0.005;

}  // namespace

// One of those that share a cell and an octant of normals: millions of points say no more than that.
Gaps::Places Gaps::Thinned(const std::vector<SurfacePoint>& points, const std::vector<OrientedPoint>& contacts,
                           const std::vector<OrientedPoint>& outline) {
  Places places;
  std::set<std::array<int64_t, 4>> taken;
  const auto add = [&](const Eigen::Vector3d& position, const Eigen::Vector3d& normal) {
    if (normal.isZero()) return;
    std::array<int64_t, 4> cell{};
    for (int axis = 0; axis < 3; ++axis) {
      cell[axis] = static_cast<int64_t>(std::floor(position[axis] / kCell));
      cell[3] |= static_cast<int64_t>(normal[axis] > 0) << axis;
    }
    if (!taken.insert(cell).second) return;
    places.positions.push_back(position);
    places.normals.push_back(normal);
  };
  for (const SurfacePoint& point : points) add(point.position, point.normal);
  for (const OrientedPoint& contact : contacts) add(contact.position, contact.normal);
  for (const OrientedPoint& place : outline) add(place.position, place.normal);
  return places;
}

Gaps::Gaps(const std::vector<SurfacePoint>& points, const std::vector<OrientedPoint>& contacts,
           const std::vector<OrientedPoint>& outline)
    : places_(Thinned(points, contacts, outline)), tree_(places_.positions, places_.normals) {}

double Gaps::At(const Eigen::Vector3d& x, const Eigen::Vector3d& normal, double at_most) const {
  double nearest2 = at_most * at_most;
  const auto leaves_out = [&](const OrientedTree::Node& node) {
    if (node.box.squaredExteriorDistance(x) >= nearest2) return true;
    return std::acos(std::clamp(normal.dot(node.axis), -1.0, 1.0)) - node.spread > kWidest + kSlack;
  };
  tree_.Walk(x, leaves_out, [&](uint32_t i) {
    if (normal.dot(places_.normals[i]) >= std::cos(kWidest))
      nearest2 = std::min(nearest2, (x - places_.positions[i]).squaredNorm());
  });
  return std::sqrt(nearest2);
}

}  // namespace glint
