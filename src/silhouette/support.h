// Outlines of several views that show the same piece of surface.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "colmap/scene.h"
#include "geometry/point_index.h"
#include "silhouette/outline.h"

namespace glint {

// What the outlines around one place say of it together.
struct Support {
  double offset = 0;  // of the surface along the sample's normal, the median, world units
  double spread = 0;  // of the offsets: 1.4826 times their median deviation
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  // the mean, unit
  size_t samples = 0;
  size_t views = 0;  // the sample's own included
};

// The samples' places (at `depth`) with an index over them. Keeps its own copies. Thread-safe.
class OutlineNeighbors {
 public:
  OutlineNeighbors(const Scene& scene, const std::vector<OutlineSample>& outline);

  const Eigen::Vector3d& Place(size_t sample) const { return places_[sample]; }

  // Neighbours within `reach` (world units) whose normals are within 30 degrees. The chord of two places on a surface
  // is at right angles to the mean of their normals: what it is off tells the offset.
  Support Of(size_t sample, double reach) const;

 private:
  std::vector<OutlineSample> outline_;
  std::vector<Eigen::Vector3d> places_;
  PointIndex index_;
};

}  // namespace glint
