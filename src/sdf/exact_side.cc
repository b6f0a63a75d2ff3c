#include "sdf/exact_side.h"

#include <limits>
#include <utility>

#include "geometry/closest_point.h"
#include "geometry/pseudo_normals.h"

namespace glint::internal {

namespace {

// The part that `face` has in the pseudo-normal of a feature of another face: its normal at an edge, its normal times
// its angle at a vertex; zero if it does not touch the feature.
Eigen::Vector3d PartOf(const TriangleMesh& mesh, const Eigen::Vector3i& face, Feature feature, int first, int second) {
  for (int k = 0; k < 3; ++k) {
    const int from = face[k], to = face[(k + 1) % 3];
    const Eigen::Vector3d &a = mesh.vertices[from], &b = mesh.vertices[to], &c = mesh.vertices[face[(k + 2) % 3]];
    if (feature == Feature::kVertex && from == first) return CornerAngle(a, b, c) * AccurateNormal(a, b, c);
    if (feature == Feature::kEdge && ((from == first && to == second) || (from == second && to == first)))
      return AccurateNormal(a, b, c);
  }
  return Eigen::Vector3d::Zero();
}

}  // namespace

bool PseudoNormalSide::Inside(const Eigen::Vector3i& voxel, const uint32_t* triangles, size_t num_triangles,
                              KnownNormals& known) const {
  const Eigen::Vector3d p = voxel.cast<double>();
  MeshPoint best{{p, std::numeric_limits<double>::infinity(), Feature::kFace, 0}, -1};
  for (size_t i = 0; i < num_triangles; ++i) {
    const Eigen::Vector3i& face = mesh_->faces[triangles[i]];
    const TrianglePoint at =
        ClosestOnTriangle(mesh_->vertices[face[0]], mesh_->vertices[face[1]], mesh_->vertices[face[2]], p);
    if (at.squared_distance < best.squared_distance) best = {at, static_cast<int>(triangles[i])};
  }
  const Eigen::Vector3i& closest = mesh_->faces[best.face];
  if (best.feature == Feature::kFace) {
    const Eigen::Vector3d normal =
        AccurateNormal(mesh_->vertices[closest[0]], mesh_->vertices[closest[1]], mesh_->vertices[closest[2]]);
    return (p - best.point).dot(normal) < 0;
  }
  const bool is_edge = best.feature == Feature::kEdge;
  int first = closest[best.corner], second = is_edge ? closest[(best.corner + 1) % 3] : -1;
  if (is_edge && second < first) std::swap(first, second);
  KnownNormals::Entry& entry = known.At(first, second);
  if (entry.first != first || entry.second != second) {
    entry = {first, second, Eigen::Vector3d::Zero()};
    for (size_t i = 0; i < num_triangles; ++i)
      entry.normal += PartOf(*mesh_, mesh_->faces[triangles[i]], best.feature, first, second);
  }
  return (p - best.point).dot(entry.normal) < 0;
}

}  // namespace glint::internal
