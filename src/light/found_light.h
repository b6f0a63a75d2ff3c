// A light that was found, and how well it is known.
#pragma once

#include <Eigen/Core>
#include <string>

#include "light/light.h"

namespace glint {

struct FoundLight {
  Light light;  // sigma: the largest standard deviation of `covariance`
  // Of light.vector: of a distant light radians² (of rank 2, across the direction), of a point light world units².
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  double support = 0;           // highlights that it explains (expected number)
  double conditioning = 0;      // least over largest eigenvalue of its normal equations, in [0, 1]
  double normal_sigma_deg = 0;  // of the surface's normals against the half vectors
  double angular_size_deg = 0;  // how far across an extended lamp is; 0: not told from a point
  double criterion_gain = 0;    // by how much it lowers the information criterion; above 10 is decisive
  bool determined = true;       // false: not to be used
  std::string why;              // it is not determined
};

}  // namespace glint
