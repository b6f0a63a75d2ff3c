// Where the surface is known to be without highlights: sparse points, places from texture, outlines.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "refine/bundle.h"
#include "refine/normalized.h"
#include "refine/outline_contacts.h"
#include "refine/photo_points.h"
#include "refine/refine.h"

namespace glint {

// All in units of the object's diagonal, as `frame` makes them. `input` is kept by reference.
class KnownPlaces {
 public:
  KnownPlaces(const RefineInput& input, const RefineOptions& options, const UnitFrame& frame, Progress& progress);

  // Places where neighbouring photographs agree on the texture of `surface` take the place of earlier ones.
  void LookForTexture(const TriangleMesh& surface, const std::vector<Light>& lights);
  // Normals, places on the surface and standard deviations across it, of the points, by the field as it is now.
  void Update(const LevelSet& field);

  // Sparse points, then those from texture.
  const std::vector<SurfacePoint>& points() const { return points_; }
  size_t num_sparse() const { return num_sparse_; }
  // What anchors the bundle: the points, and where the outlines show the surface.
  std::vector<SurfacePoint> Anchors(const LevelSet& field) const;
  // Where the outlines' rays touch the field's surface; none if they are not used.
  std::vector<OrientedPoint> Outline(const LevelSet& field) const { return OutlineContacts(outline_, field); }

 private:
  const double min_sigma_;
  size_t num_sparse_ = 0;
  std::vector<SurfacePoint> points_;
  std::vector<Eigen::Matrix3d> covariance_;  // of points_
  std::vector<OutlineRay> outline_;
  std::vector<SurfacePoint> rim_;
  PhotoPoints photo_;
};

}  // namespace glint
