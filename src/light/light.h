// Light sources: distant or point, fixed in the world or carried by the camera.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "geometry/rigid.h"

namespace glint {

enum class LightType { kDistant, kPoint };
enum class LightFrame { kWorld, kCamera };

struct Light {
  LightType type = LightType::kDistant;
  LightFrame frame = LightFrame::kWorld;
  // kDistant: unit direction to the light; kPoint: position. In `frame`'s axes and units (COLMAP's scale).
  Eigen::Vector3d vector = Eigen::Vector3d::UnitZ();
  // Standard deviation: degrees (distant) or world units (point); 0: taken as exact.
  double sigma = 0;
  std::vector<std::string> images = {};  // names of the photographs in which it shines; empty: all
};

bool ShinesIn(const Light& light, const std::string& image);

// Unit direction from the surface point to the light, in the world.
Eigen::Vector3d DirectionToLight(const Light& light, const Rigid3d& cam_from_world, const Eigen::Vector3d& x_in_world);

// Unit half vector (v + l)/|v + l| at x seen from a camera centre [SAH03]; zero where it is undefined.
Eigen::Vector3d HalfVector(const Light& light, const Rigid3d& cam_from_world, const Eigen::Vector3d& x_in_world);

}  // namespace glint
