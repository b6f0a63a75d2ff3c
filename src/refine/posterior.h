// How sure the surface is: standard deviations from the same energy that made it.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "refine/level_set_step.h"

namespace glint {

// A place each: of the position across the surface (units of the object's diagonal), and of the normal (radians: root
// mean square of the angle).
struct SurfaceDeviation {
  std::vector<float> position, normal;
};

// The energy of a step is, but for the outliers it weighs down, the negative logarithm of a Gaussian, whose covariance
// is the inverse of the energy's matrix. Too large to invert, it is sampled: each sample is a solve for targets that
// are noise (BandSystem::Deviation). An error of a light turns the normals of all its contacts at once. `at`: on the
// zero set of `input.surface`. Where that has no voxels the deviation is the seed's. A share of about 1 / sqrt(2
// samples) of the figures is chance; the same for the same input.
SurfaceDeviation PosteriorDeviation(const StepInput& input, const LevelSetOptions& options,
                                    const std::vector<Eigen::Vector3d>& at);

}  // namespace glint
