#include "refine/gaps.h"

#include <algorithm>
#include <cmath>

namespace glint {
namespace {

// What lies across a wall or around a rim says nothing of this side: a place counts fully up to 20 degrees, as ever
// farther away from there on, and not at all from 60.
constexpr double kSameSide = 0.94, kOtherSide = 0.5;
constexpr double kSlack = 1e-9;  // radians, for rounding

}  // namespace

Gaps::Places Gaps::All(const std::vector<SurfacePoint>& points, const std::vector<OrientedPoint>& contacts,
                       const std::vector<OrientedPoint>& outline) {
  Places places;
  const auto add = [&](const auto& known) {
    for (const auto& place : known) {
      if (place.normal.isZero()) continue;
      places.positions.push_back(place.position);
      places.normals.push_back(place.normal);
    }
  };
  add(points);
  add(contacts);
  add(outline);
  return places;
}

Gaps::Gaps(const std::vector<SurfacePoint>& points, const std::vector<OrientedPoint>& contacts,
           const std::vector<OrientedPoint>& outline)
    : places_(All(points, contacts, outline)), tree_(places_.positions, places_.normals) {}

double Gaps::At(const Eigen::Vector3d& x, const Eigen::Vector3d& normal, double at_most) const {
  double nearest = at_most;
  const double widest = std::acos(kOtherSide);
  const auto leaves_out = [&](const OrientedTree::Node& node) {
    if (node.box.squaredExteriorDistance(x) >= nearest * nearest) return true;
    return std::acos(std::clamp(normal.dot(node.axis), -1.0, 1.0)) - node.spread > widest + kSlack;
  };
  tree_.Walk(x, leaves_out, [&](uint32_t i) {
    const double alike = std::min((normal.dot(places_.normals[i]) - kOtherSide) / (kSameSide - kOtherSide), 1.0);
    if (alike > 0) nearest = std::min(nearest, (x - places_.positions[i]).norm() / alike);
  });
  return nearest;
}

}  // namespace glint
