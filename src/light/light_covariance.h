// How uncertain a found light is.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "light/light.h"
#include "light/light_fit.h"

namespace glint {

// Of light.vector, as in FoundLight, for a light that fits the observations. Two things make it larger than least
// squares have it. A sparse surface is too flat or too round as a whole where it is blank, which tilts a distant light
// without making the normals disagree: a small linear map of the normals, n + A n, is marginalised. And errors are
// shared by neighbours on the surface: the covariance is at least the one that is consistent with such correlation
// (Conley 1999), over whatever distance makes most of it.
// `responsibilities`: how surely each observation is the light's; `sigma`: of the normals, radians; `prior`: see
// LineariseLight().
Eigen::Matrix3d LightCovariance(const std::vector<LightObservation>& observations,
                                const Eigen::VectorXd& responsibilities, double sigma, double max_incidence_deg,
                                double diagonal, double prior, const Light& light);

// The largest standard deviation, in the units of Light::sigma.
double LargestSigma(const Eigen::Matrix3d& covariance, const Light& light);

}  // namespace glint
