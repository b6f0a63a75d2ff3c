// The Delaunay triangulation of a set of scene points with the votes of their observations.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "colmap/scene.h"
#include "seed/ray_votes.h"
#include "seed/tetrahedra.h"

namespace glint {

// What a vertex is, where it is no point of the scene.
inline constexpr int kFootVertex = -1;      // on the ground below the object
inline constexpr int kMiddleVertex = -2;    // in the middle of an edge, where sheets were separated
inline constexpr int kBackVertex = -3;      // behind a point of a thin wall
inline constexpr int kFirstRimVertex = -4;  // that of rim point i: kFirstRimVertex - i

struct SparseCells {
  Tetrahedra tetrahedra;  // its points: the chosen scene points in order, then the extra ones
  RayVotes votes;
  std::vector<int> scene_point;  // per point of the triangulation; negative: what else it is
};

// A point of the triangulation; extra ones have no lines of sight.
struct SparseVertex {
  Eigen::Vector3d position;
  int scene_point = kFootVertex;
  double sigma = 0;  // world units
};

// `context`: scene points that are no vertices, but whose lines of sight tell what is free. `free_lines`, `matter`:
// what is known besides.
SparseCells BuildSparseCells(const Scene& scene, const std::vector<SparseVertex>& vertices,
                             const std::vector<int>& context = {}, std::vector<FreeLine> free_lines = {},
                             const std::vector<MatterBehind>& matter = {});

}  // namespace glint
