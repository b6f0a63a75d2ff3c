// The visibility-consistent surface of the object's points, closed at the ground.
#pragma once

#include "colmap/scene.h"
#include "geometry/triangle_mesh.h"
#include "seed/object_choice.h"
#include "seed/reliable_points.h"
#include "seed/rim_points.h"
#include "seed/visibility_cut.h"

namespace glint {

// What a vertex of the sparse surface is, where it is no point of the scene.
inline constexpr int kFootVertex = -1;      // on the ground below the object
inline constexpr int kMiddleVertex = -2;    // in the middle of an edge, where sheets were separated
inline constexpr int kBackVertex = -3;      // behind a point of a thin wall
inline constexpr int kFirstRimVertex = -4;  // that of rim point i: kFirstRimVertex - i

struct SparseSurface {
  TriangleMesh mesh;  // closed, oriented outward, one piece; empty if the points enclose nothing
  std::vector<int>
      scene_point;          // per vertex: index into the scene's points, kFootVertex, kMiddleVertex, or a rim point's
  std::vector<int> beside;  // points of the scene that are no vertices but lie on it: of a hull, which has few vertices
};

// Matter touches only the object's points, its rim and the ground. Where the ground is hidden below the object, points
// are put on it, so that an object without texture at its foot still stands on the plane. What is seen through
// (options.see_through) is the convex hull of its points: no line of sight says where a pane ends.
SparseSurface MakeSparseSurface(const Scene& scene, const PointReliability& reliability, const ObjectChoice& choice,
                                const CutOptions& options, const RimEvidence& rim = {});

}  // namespace glint
