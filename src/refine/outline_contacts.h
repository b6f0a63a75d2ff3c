// The object's outlines as constraints on its surface: the surface touches each ray through an outline.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "colmap/scene.h"
#include "refine/bundle.h"
#include "refine/normalized.h"
#include "refine/surface_constraints.h"
#include "sdf/level_set.h"
#include "silhouette/outline.h"

namespace glint {

// A sample of an outline, its ray from `eye`. Lengths in units of the object's diagonal.
struct OutlineRay {
  Eigen::Vector3d eye, ray, normal;
  double near = 0, far = 0, sigma = 0;
};

// Some of the samples, evenly: those next to each other are wrong together, by what their edges look like, and would
// cost time.
std::vector<OutlineRay> RaysOf(const Scene& scene, const std::vector<OutlineSample>& outline, const UnitFrame& frame);

// Where the rays come nearest to the current surface: there it has to touch them, with the outline's normal. Rays
// whose nearest place is off the band, or at an end of what the other views leave room for, are left out. Lengths in
// units of the object's diagonal.
std::vector<OrientedPoint> OutlineContacts(const std::vector<OutlineRay>& outline, const LevelSet& surface);

// Where the outlines themselves show the surface, with its normal: the samples that are known well along their rays,
// one a cell of 1 % of the diagonal, in units of the diagonal. Without their foot points.
std::vector<SurfacePoint> KnownOutlinePlaces(const Scene& scene, const std::vector<OutlineSample>& outline,
                                             const UnitFrame& frame);

}  // namespace glint
