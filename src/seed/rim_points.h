// What the object's outlines add to its sparse points.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <vector>

#include "colmap/scene.h"
#include "geometry/triangle_mesh.h"
#include "seed/ray_votes.h"
#include "silhouette/outline.h"

namespace glint {

// A place on the surface that an outline shows, where there are no sparse points.
struct RimPoint {
  Eigen::Vector3d position;
  Eigen::Vector3d normal;  // unit, out of the object
  double sigma = 0;        // world units
};

// What outlines tell the sparse surface. Empty: nothing.
struct RimEvidence {
  std::vector<RimPoint> points = {};
  std::vector<FreeLine> free_lines = {};  // rays that pass just outside of the object
  double depth = 0;                       // world units: matter this far behind every rim point
  bool of_a_wall = false;                 // the points alone made sense as a thin wall only
};

struct RimOptions {
  double diagonal;         // the object's, world units
  bool carve = false;      // with rays beside all samples: one wrong outline may cut off what is thin
  bool few_sides = false;  // with samples that are known less well along their rays, or have no others beside them
};

// Places of samples, averaged over their neighbours, thinned, where `points` (the object's) are missing.
RimEvidence RimFromOutline(const Scene& scene, const std::vector<OutlineSample>& outline,
                           const std::vector<Eigen::Vector3d>& points, const RimOptions& options);

// Where not even an outline's place is near: places on what the outlines leave room for (`hull`), thinned, as far as
// they lie well outside of `shape`, away from its points and above the ground. The object ends not far below: without
// them it would end at its last point.
void AddHullPoints(const TriangleMesh& hull, const TriangleMesh& shape, const std::vector<Eigen::Vector3d>& points,
                   const std::optional<Eigen::Hyperplane<double, 3>>& ground, RimEvidence& rim);

// Share of the samples whose ray, moved into the object by a little, meets the mesh and, moved out by as much, does
// not. 1 if there are none.
double OutlineFit(const Scene& scene, const std::vector<OutlineSample>& outline, const TriangleMesh& mesh);

}  // namespace glint
