// Where the object stands.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "colmap/scene.h"
#include "seed/object_choice.h"

namespace glint {

// Points on the ground below the object's lowest points: the outline of its foot, and a grid that covers it (world
// units). Empty without a ground, or where the object shows no foot.
std::vector<Eigen::Vector3d> FootPoints(const Scene& scene, const ObjectChoice& choice);

}  // namespace glint
