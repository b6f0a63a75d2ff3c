// Lens distortion in the plane: normalised coordinates x/z, y/z for the perspective models, the equidistant plane
// (direction times angle from the axis) for the fisheye models. Internal to colmap/.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

#include "colmap/camera.h"

namespace glint::internal {

// All of COLMAP's polynomial lenses in one form, with s = |x|²:
//   radial part      q = x · N(s)/D(s)
//   decentering at b (b = q if `decenters_distorted`, else x), with t = |b|²:
//     2 p1 bx by + p2 (t + 2 bx²) + sx1 t + sx2 t²,   2 p2 bx by + p1 (t + 2 by²) + sy1 t + sy2 t²
// OpenCV's and Weng et al. 1992's models decenter the undistorted point, Project Aria's fisheye624 the distorted one.
struct Lens {
  static constexpr int kMaxDegree = 6;
  std::array<double, kMaxDegree + 1> numerator = {1, 0, 0, 0, 0, 0, 0};
  std::array<double, 4> denominator = {1, 0, 0, 0};
  double p1 = 0, p2 = 0, sx1 = 0, sx2 = 0, sy1 = 0, sy2 = 0;
  bool decenters_distorted = false;
};

// `extra`: COLMAP's parameters after the focal lengths and the principal point. Identity for models without any.
Lens MakeLens(CameraModel model, const double* extra);

// The distorted point; nullopt beyond the range around the axis where the distortion is one to one.
std::optional<Eigen::Vector2d> Distort(const Lens& lens, const Eigen::Vector2d& x);

// The point within that range that is distorted to `distorted`; nullopt if there is none.
std::optional<Eigen::Vector2d> Undistort(const Lens& lens, const Eigen::Vector2d& distorted);

}  // namespace glint::internal
