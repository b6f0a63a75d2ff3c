// The libraries that Glint is measured against.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <string>

#include "geometry/pseudo_normals.h"
#include "geometry/triangle_mesh.h"
#include "sdf/level_set.h"

namespace glint::benchmark {

// Distances of points by a library's tree, signed by Glint's angle-weighted pseudo-normals.
class PointPeer {
 public:
  virtual ~PointPeer() = default;
  virtual std::string Name() const = 0;
  // Of n points, each at most `step` from the one before; `reach` bounds the search (a distance that is further off may
  // come out as `reach`). Called from several threads.
  virtual void Distances(const Eigen::Vector3d* points, size_t n, double step, double reach, float* out) const = 0;
};

// Keep references.
std::unique_ptr<PointPeer> MakeEmbreePeer(const TriangleMesh& mesh, const PseudoNormals& normals);
std::unique_ptr<PointPeer> MakeCgalPeer(const TriangleMesh& mesh, const PseudoNormals& normals);

// OpenVDB's meshToVolume with the same voxels and band.
LevelSet OpenVdbLevelSet(const TriangleMesh& mesh, double voxel_size, double half_width_voxels);

}  // namespace glint::benchmark
