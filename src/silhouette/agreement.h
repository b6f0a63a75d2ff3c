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

inline constexpr size_t kMinWitnesses = 4;  // views that must see a place to say something of it

// The masks, and how many of them must say so before a place is excluded: not the largest distance by which a mask
// excludes it counts, but the one that so many exceed or reach, so that fewer wrong ones decide nothing.
struct MaskSet {
  std::vector<ViewMask> masks;
  int contradictions = 2;
};

// By how much x is outside of what the masks leave room for, world units.
std::optional<double> OutsideBy(const Scene& scene, const MaskSet& set, const Eigen::Vector3d& x);

// The same, but for the share of the masks that may be wrong; nothing, too, where fewer than half of them know of x.
std::optional<double> OutsideByMost(const Scene& scene, const std::vector<ViewMask>& masks, const Eigen::Vector3d& x,
                                    double wrong_share);

// How deep x is in the holes of at least so many masks' outlines, world units; negative: not in so many. Nothing where
// fewer have any.
std::optional<double> SeenThroughBy(const Scene& scene, const MaskSet& set, size_t views, const Eigen::Vector3d& x);

// A ball that holds the object with room to spare.
struct Reach {
  Eigen::Vector3d center;
  double radius;
};

// Sets near, depth and far of the sample by the masks of the other views; returns by how much they have it outside at
// `depth`, the least along the ray. Nothing where they say nothing. `slack`: world units by which that may be exceeded
// in [near, far].
std::optional<double> FindContact(const Scene& scene, const MaskSet& set, int own, const Reach& reach, double slack,
                                  OutlineSample& sample);

}  // namespace glint::internal
