// How uncertain a found light is.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "light/light.h"
#include "light/light_fit.h"

namespace glint {

// Of light.vector, as in FoundLight, for the light that fits the observations best. The errors of a seed's normals are
// not independent: neighbours on the surface share them, and a sparse surface is too flat or too round as a whole where
// it is blank, which tilts a distant light without making the normals disagree much. How far errors are shared, how
// much of them is, and how large a linear map of all normals, n + A n, may be, is not known: such hypotheses are
// weighed by their restricted likelihood given the observations (Patterson, Thompson 1971) and averaged over. Nothing
// else makes the covariance larger than the disagreements say.
// `responsibilities`: how surely each observation is the light's; `sigma`: of the normals, radians; `prior`: see
// LineariseLight().
Eigen::Matrix3d LightCovariance(const std::vector<LightObservation>& observations,
                                const Eigen::VectorXd& responsibilities, double sigma, double max_incidence_deg,
                                double diagonal, double prior, const Light& light);

// How uncertain the light leaves the half vectors at its highlights: the largest standard deviation, root mean square
// over them, radians.
double HalfVectorSigma(const std::vector<LightObservation>& of_light, const Eigen::Matrix3d& covariance,
                       double diagonal, const Light& light);

// The largest standard deviation, in the units of Light::sigma.
double LargestSigma(const Eigen::Matrix3d& covariance, const Light& light);

}  // namespace glint
