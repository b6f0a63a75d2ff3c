// The sides of single voxels by pseudo-normals, in double.
#pragma once

#include "geometry/triangle_mesh.h"
#include "sdf/tile_kernel.h"

namespace glint::internal {

// sign(r·N) with the feature that the closest point lies on [BA05]. Every face around that feature is as close as the
// feature itself, and so is among the triangles given: its pseudo-normal is worked out from them, and no mesh-wide
// normals or neighbours are needed. Keeps a reference.
class PseudoNormalSide : public ExactSide {
 public:
  explicit PseudoNormalSide(const TriangleMesh& mesh_in_index) : mesh_(&mesh_in_index) {}
  bool Inside(const Eigen::Vector3i& voxel, const uint32_t* triangles, size_t num_triangles,
              KnownNormals& known) const override;

 private:
  const TriangleMesh* mesh_;
};

}  // namespace glint::internal
