// The sparse points that structure from motion would give.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "synthetic/stage.h"
#include "synthetic/synthetic_options.h"

namespace glint {

struct SyntheticObservation {
  size_t view;
  Eigen::Vector2d px;  // with noise
};

struct SyntheticPoint {
  enum class Origin { kMark, kGround, kInterior, kHighlight };
  Origin origin;
  Eigen::Vector3d truth;     // on a surface; of a virtual point (kHighlight) one of its contacts
  Eigen::Vector3d position;  // triangulated from the noisy observations with the true cameras
  std::array<uint8_t, 3> rgb;
  double error_px;                                 // mean reprojection error
  std::vector<SyntheticObservation> observations;  // at least three views, at most one a view, by view
};

// In the stage's frame: points on the object's marks and on the texture around it, and virtual ones triangulated on
// highlights that slide over the object.
std::vector<SyntheticPoint> MakeSparsePoints(const Stage& stage, const SyntheticOptions& options);

}  // namespace glint
