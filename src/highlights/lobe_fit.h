// The peak of a highlight from its flank.
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

namespace glint {

struct LobeFit {
  bool ok = false;
  Eigen::Vector2d peak;        // pixels of the map, OpenCV's frame
  Eigen::Matrix2d covariance;  // of the peak, pixels²
  double profile_error = 0;    // robust residual relative to the rise seen; 0: too much is saturated to tell
  double saturated_fraction = 0;
};

// Fits  body + amplitude (1 + q(x))^-2  with q = uᵀu exp(kᵀu), u = Lᵀ(x - peak): the image of a GGX lobe on a smooth
// surface, where the half vector's angle grows about linearly with the distance from the peak (D ~ (1 + tan²θ/α²)^-2,
// Walter et al. 2007); k lets the lobe be lopsided, as it is where the curvature changes, and u is bent across the
// blob's long axis, as streaks are. Cauchy's cost over the pixels within an ellipse somewhat larger than the blob.
// Pixels at or above `saturation` only say "at least that bright". What can not come closer than `max_profile_error` is
// given up half way, with a profile error above that. `map`: CV_16UC1 linear; `centroid`, `moments`: of the part above
// half height; `mask`: CV_8U or empty.
LobeFit FitLobe(const cv::Mat& map, const cv::Mat& mask, const Eigen::Vector2d& centroid,
                const Eigen::Matrix2d& moments, double body, double peak_value, double saturation,
                double max_profile_error);

}  // namespace glint
