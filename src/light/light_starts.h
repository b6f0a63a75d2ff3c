// Where to begin looking for a light.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "light/light.h"
#include "light/light_fit.h"

namespace glint {

// The distant lights (at most `count`, more than 2.5 `sigma` apart) of a grid over all directions that the weighted
// observations vote for most, each with a Gaussian of `sigma` radians about its normal.
std::vector<Light> LikelyDirections(const std::vector<LightObservation>& observations, const Eigen::VectorXd& weights,
                                    LightFrame frame, double max_incidence_deg, double sigma, int count);

// A point light `distance` from the object's centre where the distant one shines from; in the camera's frame from the
// centre's mean place there.
Light AtDistance(const std::vector<LightObservation>& observations, const Light& distant, const Eigen::Vector3d& center,
                 double distance);

}  // namespace glint
