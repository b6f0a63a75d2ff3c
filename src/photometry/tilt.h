// A normal's component along a direction: what shading and normal maps say of a surface.
#pragma once

#include <Eigen/Core>

namespace glint {

// World units.
struct Tilt {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();  // unit
  double cosine = 0;                                    // normal . direction
  double sigma = 0;                                     // of the cosine
  double radius_world = 0;                              // of the patch over which it is a mean
  double share = 1;                                     // of its weight that counts: its neighbours err alike
};

}  // namespace glint
