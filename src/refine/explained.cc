#include "refine/explained.h"

#include <algorithm>
#include <cmath>

namespace glint {
namespace {

constexpr double kMostRatio2 = 9;  // squared distance, in reaches
constexpr double kSlack = 1e-9;    // for rounding

double FallOff(double ratio2) { return std::exp(-0.5 * ratio2 * ratio2); }

OrientedTree TreeOf(const std::vector<OrientedPoint>& contacts) {
  std::vector<Eigen::Vector3d> positions, normals;
  for (const OrientedPoint& contact : contacts) {
    positions.push_back(contact.position);
    normals.push_back(contact.normal);
  }
  return {positions, normals};
}

}  // namespace

Explained::Explained(const std::vector<OrientedPoint>& contacts) : contacts_(contacts), tree_(TreeOf(contacts)) {
  for (const OrientedPoint& contact : contacts) longest_reach_ = std::max(longest_reach_, contact.reach);
}

double Explained::At(const Eigen::Vector3d& x, const Eigen::Vector3d& normal) const {
  double explained = 0;
  if (normal.isZero()) return explained;
  const double reach2 = longest_reach_ * longest_reach_;
  // No contact below the node could say more than what is known already.
  const auto leaves_out = [&](const OrientedTree::Node& node) {
    const double ratio2 = (1 - kSlack) * node.box.squaredExteriorDistance(x) / reach2;
    if (ratio2 > kMostRatio2 || FallOff(ratio2) < (1 - kSlack) * explained) return true;
    return node.FacesAway(normal);
  };
  tree_.Walk(x, leaves_out, [&](uint32_t i) {
    const OrientedPoint& contact = contacts_[i];
    const double ratio2 = (x - contact.position).squaredNorm() / (contact.reach * contact.reach);
    if (ratio2 > kMostRatio2) return;
    explained = std::max(explained, FacingAlike(contact.normal, normal) * FallOff(ratio2));
  });
  return explained;
}

}  // namespace glint
