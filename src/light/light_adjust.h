// One light against the normals under its highlights.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "light/light.h"
#include "light/light_fit.h"

namespace glint {

// Tangent coordinates of a light: two of the direction (radians), or three of the position (in units of `diagonal`).
int NumParameters(const Light& light);

// What a step of one in each coordinate adds to light.vector; the third column is zero for a distant light.
Eigen::Matrix3d TangentBasis(const Light& light, double diagonal);

// Derivative of the half vector by the tangent coordinates, by central differences.
Eigen::Matrix3d HalfVectorJacobian(const LightObservation& observation, const Light& light, double diagonal);

// The light after a step in its tangent coordinates.
Light Moved(const Light& light, double diagonal, const Eigen::Vector3d& step);

// Gauss-Newton equations of sum w |h - n|², h the half vector and n the normal, in the tangent coordinates.
// Observations beyond the incidence limit do not count. To the cost of a point light in the camera's frame `prior`
// times its squared distance from the camera, in diagonals, is added.
struct LightEquations {
  Eigen::Matrix3d hessian = Eigen::Matrix3d::Zero();
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  double cost = 0;
};
LightEquations LineariseLight(const std::vector<LightObservation>& observations, const Eigen::VectorXd& weights,
                              const Light& light, double max_incidence_deg, double diagonal, double prior);

// A few damped Gauss-Newton steps.
void AdjustLight(const std::vector<LightObservation>& observations, const Eigen::VectorXd& weights,
                 double max_incidence_deg, double diagonal, double prior, Light& light);

}  // namespace glint
