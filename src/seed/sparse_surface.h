// The visibility-consistent surface of the object's points, closed at the ground.
#pragma once

#include "colmap/scene.h"
#include "geometry/triangle_mesh.h"
#include "seed/object_choice.h"
#include "seed/reliable_points.h"
#include "seed/visibility_cut.h"

namespace glint {

struct SparseSurface {
  TriangleMesh mesh;             // closed, oriented outward, one piece; empty if the points enclose nothing
  std::vector<int> scene_point;  // per vertex: index into the scene's points; −1: on the ground below the object
};

// Matter touches only the object's points and the ground. Where the ground is hidden below the object, points are put
// on it, so that an object without texture at its foot still stands on the plane.
SparseSurface MakeSparseSurface(const Scene& scene, const PointReliability& reliability, const ObjectChoice& choice,
                                const CutOptions& options);

}  // namespace glint
