// The visibility-consistent surface of the object's points, closed at the ground.
#pragma once

#include "colmap/scene.h"
#include "geometry/triangle_mesh.h"
#include "seed/object_choice.h"
#include "seed/reliable_points.h"
#include "seed/rim_points.h"
#include "seed/sparse_cells.h"
#include "seed/visibility_cut.h"

namespace glint {

struct SparseSurface {
  TriangleMesh mesh;             // closed, oriented outward, one piece; empty if the points enclose nothing
  std::vector<int> scene_point;  // per vertex: index into the scene's points, or what else it is (seed/sparse_cells.h)
  bool is_wall = false;          // made with a back behind every point
  std::vector<int> beside;  // points of the scene that are no vertices but lie on it: of a hull, which has few vertices
};

// Matter touches only the object's points, its rim and the ground. Where the ground is hidden below the object, points
// are put on it, so that an object without texture at its foot still stands on the plane. What is seen through
// (options.see_through) is the convex hull of its points: no line of sight says where a pane ends.
SparseSurface MakeSparseSurface(const Scene& scene, const PointReliability& reliability, const ObjectChoice& choice,
                                const CutOptions& options, const RimEvidence& rim = {});

}  // namespace glint
