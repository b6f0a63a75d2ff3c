// Nearest hits of rays with a triangle mesh, on Embree.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>

#include "geometry/triangle_mesh.h"

namespace glint {

struct RayHit {
  double t;  // distance along the (unit) direction
  Eigen::Vector3d position;
  Eigen::Vector3d normal;  // unit geometric normal of the face, as the mesh is oriented
  int face;
  double u, v;  // barycentric weights of the face's second and third vertex
};

// Keeps its own copy of the geometry. Queries are thread-safe. Embree works in float: positions are good to
// about 1e-6 of the mesh's extent (the mesh is centred and scaled before it is handed over).
class RayCaster {
 public:
  explicit RayCaster(const TriangleMesh& mesh);
  ~RayCaster();
  RayCaster(RayCaster&&) noexcept;
  RayCaster& operator=(RayCaster&&) noexcept;

  // First hit with t in (t_min, t_max); `direction` must be of unit length; lengths in world units.
  std::optional<RayHit> Intersect(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, double t_min = 0,
                                  double t_max = 1e300) const;

  // True if anything lies on the open segment between a and b, `margin` (world units) away from both ends.
  bool Occluded(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double margin) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace glint
