// How sharply a surface turns.
#pragma once

#include <Eigen/Core>

#include "sdf/level_set.h"

namespace glint {

// The largest angle (radians) between the normals `reach` to either side of x, a place on the surface of `field` whose
// normal is `normal` (unit), over four ways along it. 0 where the field has none. Thread-safe.
double LargestTurn(const LevelSet& field, const Eigen::Vector3d& x, const Eigen::Vector3d& normal, double reach);

}  // namespace glint
