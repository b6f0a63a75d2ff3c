// The object moved and scaled to the unit of its bounding-box diagonal, so that no constant depends on COLMAP's scale.
#pragma once

#include <Eigen/Core>

#include "constraints/contact.h"
#include "geometry/triangle_mesh.h"
#include "light/light.h"

namespace glint {

// x_in_unit = scale * (x_in_world − center).
struct UnitFrame {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  double scale = 1;

  static UnitFrame Of(const TriangleMesh& mesh);

  Eigen::Vector3d FromWorld(const Eigen::Vector3d& x) const { return scale * (x - center); }
  Eigen::Vector3d ToWorld(const Eigen::Vector3d& x) const { return x / scale + center; }

  TriangleMesh FromWorld(TriangleMesh mesh) const;
  TriangleMesh ToWorld(TriangleMesh mesh) const;
  Contact FromWorld(const Contact& contact) const;
  Contact ToWorld(const Contact& contact) const;
  Light FromWorld(Light light) const;
  Light ToWorld(Light light) const;
};

}  // namespace glint
