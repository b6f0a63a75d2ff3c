// What the cameras look at, and the plane that it stands on.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <vector>

#include "colmap/scene.h"

namespace glint {

// The point nearest to the optical axes (robust least squares, with a weak pull to the depth at which each view has its
// points, so that parallel axes give an answer too) and the median distance of the cameras from it.
struct Focus {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  double distance = 0;  // world units
};

// Needs at least one view. `use`: per scene point, non-zero for those to take depths from.
Focus FindFocus(const Scene& scene, const std::vector<uint8_t>& use);

// A plane with the object on its positive side.
struct GroundPlane {
  Eigen::Hyperplane<double, 3> plane;
  double tolerance = 0;  // world units: points this close belong to it
};

// The plane (RANSAC, then least squares) that carries many of the points around the focus, has the cameras and nearly
// all the points on one side, and reaches round below the focus; nullopt where there is no such plane.
std::optional<GroundPlane> FindGround(const Scene& scene, const std::vector<uint8_t>& use, const Focus& focus);

}  // namespace glint
