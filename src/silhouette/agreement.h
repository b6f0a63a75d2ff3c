// What the masks of all views together leave room for. Only for .cc files of this module: it brings OpenCV along.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "colmap/scene.h"
#include "silhouette/outline.h"
#include "silhouette/view_mask.h"

namespace glint::internal {

// Rather than the largest distance by which a mask excludes a place, the one that this many masks exceed or reach: one
// wrong view alone decides nothing.
inline constexpr int kContradictions = 2;
inline constexpr int kMinWitnesses = 4;  // views that must see a place to say something of it

// By how much x is outside of what the masks (but `skip`) leave room for, world units.
std::optional<double> OutsideBy(const Scene& scene, const std::vector<ViewMask>& masks, const Eigen::Vector3d& x,
                                int skip = -1);

// A ball that holds the object with room to spare.
struct Reach {
  Eigen::Vector3d center;
  double radius;
};

// Sets near, depth and far of the sample by the masks of the other views; returns OutsideBy at `depth`, the least along
// the ray. Nothing where they say nothing. `slack`: world units by which OutsideBy may exceed its least in [near, far].
std::optional<double> FindContact(const Scene& scene, const std::vector<ViewMask>& masks, int own, const Reach& reach,
                                  double slack, OutlineSample& sample);

}  // namespace glint::internal
