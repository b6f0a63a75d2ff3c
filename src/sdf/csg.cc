#include "sdf/csg.h"

#include <openvdb/tools/Composite.h>

#include <algorithm>
#include <cmath>

#include "sdf/extract_mesh.h"
#include "sdf/level_set_impl.h"
#include "sdf/mesh_to_level_set.h"

namespace glint {
namespace {

// In voxels about the first mesh: the result does not depend on where the world has its origin, nor on its unit.
TriangleMesh InVoxels(const TriangleMesh& mesh, const Eigen::Vector3d& center, double voxel) {
  TriangleMesh out{mesh.vertices, mesh.faces, {}, {}, {}, {}};
  for (Eigen::Vector3d& x : out.vertices) x = (x - center) / voxel;
  return out;
}

template <class Combine>
TriangleMesh Combined(const TriangleMesh& a, const TriangleMesh& b, double voxel_size_world, const Combine& combine) {
  const Eigen::Vector3d center = BoundingBox(a).center();
  const LevelSet first = MeshToLevelSet(InVoxels(a, center, voxel_size_world), 1),
                 second = MeshToLevelSet(InVoxels(b, center, voxel_size_world), 1);
  TriangleMesh out = ExtractMesh(MakeLevelSet(combine(*first.impl().grid, *second.impl().grid)));
  for (Eigen::Vector3d& x : out.vertices) x = center + voxel_size_world * x;
  return out;
}

// The greater of a field and another's negative, with a parabola over the last k voxels where they cross.
void RoundEdges(const openvdb::FloatGrid& first, const openvdb::FloatGrid& second, float k, openvdb::FloatGrid& out) {
  const auto a = first.getConstAccessor(), b = second.getConstAccessor();
  for (auto it = out.beginValueOn(); it; ++it) {
    const float x = a.getValue(it.getCoord()), y = -b.getValue(it.getCoord());
    const float near = std::max(k - std::abs(x - y), 0.0F) / k;
    it.setValue(std::max(x, y) + 0.25F * k * near * near);
  }
}

}  // namespace

TriangleMesh Union(const TriangleMesh& a, const TriangleMesh& b, double voxel_size_world) {
  return Combined(a, b, voxel_size_world, openvdb::tools::csgUnionCopy<openvdb::FloatGrid>);
}

TriangleMesh Difference(const TriangleMesh& a, const TriangleMesh& b, double voxel_size_world, double rounding_world) {
  const auto k = static_cast<float>(rounding_world / voxel_size_world);
  return Combined(a, b, voxel_size_world, [k](const openvdb::FloatGrid& first, const openvdb::FloatGrid& second) {
    openvdb::FloatGrid::Ptr out = openvdb::tools::csgDifferenceCopy(first, second);
    if (k > 0) RoundEdges(first, second, k, *out);
    return out;
  });
}

TriangleMesh Closing(const TriangleMesh& mesh, double voxel_size_world, double radius_world) {
  const Eigen::Vector3d center = BoundingBox(mesh).center();
  const double radius = radius_world / voxel_size_world;
  const SdfOptions wide{.half_width_voxels = radius + 2};
  const TriangleMesh dilated = ExtractMesh(MeshToLevelSet(InVoxels(mesh, center, voxel_size_world), 1, wide), radius);
  TriangleMesh out = ExtractMesh(MeshToLevelSet(dilated, 1, wide), -radius);
  for (Eigen::Vector3d& x : out.vertices) x = center + voxel_size_world * x;
  return out;
}

}  // namespace glint
