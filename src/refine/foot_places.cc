#include "refine/foot_places.h"

#include <algorithm>
#include <limits>

#include "core/check.h"

namespace glint {
namespace {

constexpr size_t kMostPlaces = 20000;

}  // namespace

FootPlaces::Places FootPlaces::All(const TriangleMesh& seed, const std::vector<float>& foot) {
  Places places;
  if (std::none_of(foot.begin(), foot.end(), [](float f) { return f > 0; })) return places;
  GLINT_CHECK_EQ(foot.size(), seed.vertices.size());
  GLINT_CHECK_EQ(seed.normals.size(), seed.vertices.size());
  const size_t stride = std::max<size_t>(1, seed.vertices.size() / kMostPlaces);
  for (size_t v = 0; v < seed.vertices.size(); v += stride) {
    places.positions.push_back(seed.vertices[v]);
    places.normals.push_back(seed.normals[v]);
    places.on_foot.push_back(foot[v] > 0);
  }
  return places;
}

FootPlaces::FootPlaces(const TriangleMesh& seed, const std::vector<float>& foot)
    : places_(All(seed, foot)), tree_(places_.positions, places_.normals) {}

bool FootPlaces::At(const Eigen::Vector3d& x, const Eigen::Vector3d& normal) const {
  double nearest = std::numeric_limits<double>::infinity();
  bool on_foot = false;
  const auto leaves_out = [&](const OrientedTree::Node& node) {
    return node.box.squaredExteriorDistance(x) >= nearest || node.FacesAway(normal);
  };
  tree_.Walk(x, leaves_out, [&](uint32_t i) {
    const double squared = (x - places_.positions[i]).squaredNorm();
    if (squared >= nearest || FacingAlike(normal, places_.normals[i]) <= 0) return;
    nearest = squared;
    on_foot = places_.on_foot[i] != 0;
  });
  return on_foot;
}

}  // namespace glint
