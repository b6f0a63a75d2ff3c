// Lays a mesh on a reference that is in another frame.
#pragma once

#include <Eigen/Geometry>

#include "core/progress.h"
#include "geometry/triangle_mesh.h"

namespace glint {

struct Alignment {
  // x_in_reference = reference_from_mesh * x_in_mesh: a turn, a move, and a scale if it was asked for.
  Eigen::Affine3d reference_from_mesh = Eigen::Affine3d::Identity();
  double scale = 1;
  double turned_deg = 0;
  // Mean distance from surface to surface, both ways, over the nine tenths of the samples that are closest; fractions
  // of the reference's diagonal.
  double mean_rel = 0;
};

// The turn, move and scale that bring the two surfaces closest, by the distances along the normals from samples of
// each to the other (iterative closest points, Chen & Medioni 1992; both ways, else a free scale would shrink the mesh
// into the reference). It starts at `start` and at about a hundred other turns about the middles, so the frames may be
// any; the best is kept, and `start` if no other is clearly better, as where the object is symmetric. Surfaces of which
// less than about half is common to both are not found. `with_scale` false: sizes stay. Both meshes with area.
Alignment AlignMeshes(const TriangleMesh& mesh, const TriangleMesh& reference, bool with_scale,
                      const Eigen::Affine3d& start = Eigen::Affine3d::Identity(),
                      Progress& progress = Progress::Silent());

}  // namespace glint
