#include "refine/gaps.h"

#include <algorithm>

namespace glint {

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
  const auto leaves_out = [&](const OrientedTree::Node& node) {
    if (node.box.squaredExteriorDistance(x) >= nearest * nearest) return true;
    return node.FacesAway(normal);
  };
  tree_.Walk(x, leaves_out, [&](uint32_t i) {
    const double alike = FacingAlike(normal, places_.normals[i]);
    if (alike > 0) nearest = std::min(nearest, (x - places_.positions[i]).norm() / alike);
  });
  return nearest;
}

}  // namespace glint
