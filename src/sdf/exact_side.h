// The sides of single voxels by pseudo-normals, in double.
#pragma once

#include "geometry/pseudo_normals.h"
#include "geometry/triangle_mesh.h"
#include "sdf/tile_kernel.h"

namespace glint::internal {

// sign(r·N) with the feature that the closest point lies on [BA05]. Keeps references.
class PseudoNormalSide : public ExactSide {
 public:
  PseudoNormalSide(const TriangleMesh& mesh_in_index, const PseudoNormals& normals)
      : mesh_(&mesh_in_index), normals_(&normals) {}
  bool Inside(const Eigen::Vector3i& voxel, const uint32_t* triangles, size_t num_triangles) const override;

 private:
  const TriangleMesh* mesh_;
  const PseudoNormals* normals_;
};

}  // namespace glint::internal
