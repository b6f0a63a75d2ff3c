// The seed as the gate sees it: only about right, so every question is asked of a neighbourhood.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "geometry/ray_caster.h"
#include "geometry/triangle_mesh.h"

namespace glint {

struct SurfaceSample {
  Eigen::Vector3d position;
  Eigen::Vector3d normal;  // unit, smoothed over the seed's facets, outward
};

class SeedSurface {
 public:
  // `error_world`: how far the seed may be off.
  SeedSurface(const TriangleMesh& mesh, double error_world);

  // What rays about `direction` from `origin` hit, spread over a disc of radius error_world at the surface and facing
  // the origin. The central ray comes first if it hits. Empty: off the surface.
  std::vector<SurfaceSample> Neighbourhood(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const;

  // True if the seed stands between the two points by more than it may be off.
  bool Occluded(const Eigen::Vector3d& from, const Eigen::Vector3d& to) const;

  double error_world() const { return error_world_; }
  double diagonal() const { return diagonal_; }

 private:
  std::optional<SurfaceSample> Hit(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const;

  std::vector<Eigen::Vector3i> faces_;
  std::vector<Eigen::Vector3d> normals_;  // at the vertices
  RayCaster caster_;
  Eigen::Vector3d center_;
  double diagonal_;
  double error_world_;
};

}  // namespace glint
