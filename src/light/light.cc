#include "light/light.h"

#include <algorithm>

namespace glint {

bool ShinesIn(const Light& light, const std::string& image) {
  return light.images.empty() || std::find(light.images.begin(), light.images.end(), image) != light.images.end();
}

Eigen::Vector3d DirectionToLight(const Light& light, const Rigid3d& cam_from_world, const Eigen::Vector3d& x_in_world) {
  if (light.type == LightType::kDistant)
    return light.frame == LightFrame::kWorld ? light.vector
                                             : Eigen::Vector3d(cam_from_world.rotation.conjugate() * light.vector);
  const Eigen::Vector3d position =
      light.frame == LightFrame::kWorld ? light.vector : cam_from_world.Inverse() * light.vector;
  return (position - x_in_world).normalized();
}

Eigen::Vector3d HalfVector(const Light& light, const Rigid3d& cam_from_world, const Eigen::Vector3d& x_in_world) {
  const Eigen::Vector3d center = cam_from_world.Inverse().translation;
  const Eigen::Vector3d h = (center - x_in_world).normalized() + DirectionToLight(light, cam_from_world, x_in_world);
  const double length = h.norm();
  return length > 1e-9 ? Eigen::Vector3d(h / length) : Eigen::Vector3d::Zero();
}

}  // namespace glint
