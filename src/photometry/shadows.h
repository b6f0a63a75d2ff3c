// What the lights do to places of a surface that throws shadows upon itself.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "geometry/ray_caster.h"
#include "geometry/rigid.h"
#include "geometry/triangle_mesh.h"
#include "light/light.h"

namespace glint {

class Shadows {
 public:
  explicit Shadows(const TriangleMesh& surface);

  // A vector to the light, 1 long for distant ones and where a near one shines on the middle of the surface, falling
  // off with the square of the distance. Zero where the place is dark for sure: turned away, or hidden with all about
  // it. Nothing where that is in doubt, near the edge of a shadow: the surface is only about right.
  std::optional<Eigen::Vector3d> Irradiance(const Eigen::Vector3d& x, const Eigen::Vector3d& normal, const Light& light,
                                            const Rigid3d& cam_from_world) const;

 private:
  int NumHidden(const Eigen::Vector3d& x, const Eigen::Vector3d& normal, const Eigen::Vector3d& lamp) const;

  const RayCaster caster_;
  const double diagonal_;
  const Eigen::Vector3d center_;
};

}  // namespace glint
