// The seed as the gate sees it: only about right, so every question is asked of a neighbourhood.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "colmap/scene.h"
#include "geometry/ray_caster.h"
#include "geometry/triangle_mesh.h"

namespace glint {

// The seed's attribute that is 1 where it is finer than fairing makes it: rims and hollows. Their normals are rough.
inline constexpr const char* kFineScalar = "fine";

struct SurfaceSample {
  Eigen::Vector3d position;
  Eigen::Vector3d normal;   // unit, smoothed over the seed's facets, outward
  double spread_world = 0;  // over how wide a patch the seed's normals say something about this place
  double error_world = 0;   // how far the seed may be off here
  bool fine = false;        // a rim or a hollow (kFineScalar)
  double off_center = 0;    // how far from the central ray, fraction of the spread
};

// Area-weighted vertex normals, smoothed over the one-ring a few times: the facets of a sparse seed are off by tens of
// degrees one by one, much less on average.
std::vector<Eigen::Vector3d> SmoothNormals(const TriangleMesh& mesh);

class SeedSurface {
 public:
  // `max_error_world`: how far the seed may be off where it is worst. Between sparse points it cannot be much worse
  // than they are apart, which bounds it locally.
  SeedSurface(const TriangleMesh& mesh, const std::vector<ScenePoint>& points, double max_error_world);

  // What rays about `direction` from `origin` hit, spread over a disc as wide as the seed may be off there and facing
  // the origin. The central ray comes first if it hits. Empty: off the surface.
  std::vector<SurfaceSample> Neighbourhood(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const;

  // Where the ray meets the seed; position and normal only.
  std::optional<SurfaceSample> Meet(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const;

  // True if the seed stands between a surface point and another point by more than it may be off at the first.
  bool Occluded(const SurfaceSample& from, const Eigen::Vector3d& to) const;

  double diagonal() const { return diagonal_; }

 private:
  double SpreadAt(const Eigen::Vector3d& x) const;

  std::vector<Eigen::Vector3i> faces_;
  std::vector<Eigen::Vector3d> normals_;  // at the vertices
  std::vector<uint8_t> fine_;             // of the vertices
  RayCaster caster_;
  Eigen::Vector3d center_;
  double diagonal_;
  double max_error_world_;
  std::vector<Eigen::Vector3d> points_;  // of the scene, at most kMaxPoints
  double spacing_scale_;                 // for those left out
};

}  // namespace glint
