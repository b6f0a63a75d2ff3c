// How thin a solid is, against the voxels that are to carry it.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "geometry/point_index.h"
#include "geometry/triangle_mesh.h"
#include "sdf/level_set.h"

namespace glint {

// Thickness below which a fiftieth of the surface lies: along the inward normal to the other side, in the mesh's unit.
// The mesh has vertex normals, is closed and oriented outward.
double ThinnestWalls(const TriangleMesh& mesh);

// Where the voxels of `field`, the distances to `surface`, do not carry what a normal says: where the surface turns by
// 60 degrees over three voxels (a rim, an edge), and where a wall has fewer voxels than the field needs on either side.
// Evidence would wear the surface down there; if the seed is good there, near one of the places in `fine`, it is better
// held. Thread-safe.
class Unresolved {
 public:
  Unresolved(const TriangleMesh& surface, const LevelSet& field, const std::vector<Eigen::Vector3d>& fine);
  bool Near(const Eigen::Vector3d& x) const;

 private:
  std::vector<Eigen::Vector3d> positions_;
  std::optional<PointIndex> places_;  // nothing if there are none
  double reach_;
};

}  // namespace glint
