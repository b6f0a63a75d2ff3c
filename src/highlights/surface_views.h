// Which views see a place of the surface.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "colmap/scene.h"
#include "geometry/ray_caster.h"
#include "geometry/triangle_mesh.h"

namespace glint {

struct SeenBy {
  uint32_t view;
  Eigen::Vector2f px;
  float cosine;  // of the incidence
};

// Keeps a reference to the scene.
class SurfaceViews {
 public:
  SurfaceViews(const TriangleMesh& surface, const Scene& scene);

  // Those that see a place with this normal unhidden by the surface and within its camera's image, the squarest first,
  // at most `max_views` and none below `min_cosine`.
  std::vector<SeenBy> Squarest(const Eigen::Vector3d& x, const Eigen::Vector3d& normal, double min_cosine,
                               size_t max_views) const;

 private:
  const Scene& scene_;
  RayCaster caster_;
  double margin_world_;  // a place is not hidden by the faces around it
  std::vector<Eigen::Vector3d> centers_;
};

}  // namespace glint
