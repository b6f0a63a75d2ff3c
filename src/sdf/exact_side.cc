#include "sdf/exact_side.h"

#include <limits>

namespace glint::internal {

bool PseudoNormalSide::Inside(const Eigen::Vector3i& voxel, const uint32_t* triangles, size_t num_triangles) const {
  const Eigen::Vector3d p = voxel.cast<double>();
  MeshPoint best{{p, std::numeric_limits<double>::infinity(), Feature::kFace, 0}, -1};
  for (size_t i = 0; i < num_triangles; ++i) {
    const Eigen::Vector3i& face = mesh_->faces[triangles[i]];
    const TrianglePoint at =
        ClosestOnTriangle(mesh_->vertices[face[0]], mesh_->vertices[face[1]], mesh_->vertices[face[2]], p);
    if (at.squared_distance < best.squared_distance) best = {at, static_cast<int>(triangles[i])};
  }
  return (p - best.point).dot(normals_->Of(*mesh_, best)) < 0;
}

}  // namespace glint::internal
