#include "sdf/field_mesh.h"

#include <openvdb/openvdb.h>
#include <openvdb/tools/VolumeToMesh.h>

#include "core/parallel.h"
#include "sdf/triangulate_quads.h"

namespace glint {

TriangleMesh MeshOfField(const DenseField& field, const Eigen::Affine3d& world_from_index, double iso) {
  const auto grid = openvdb::FloatGrid::create(std::numeric_limits<float>::max());
  grid->setGridClass(openvdb::GRID_LEVEL_SET);  // or the mesher turns the faces round
  auto voxels = grid->getAccessor();
  for (int x = 0; x < field.size[0]; ++x)
    for (int y = 0; y < field.size[1]; ++y)
      for (int z = 0; z < field.size[2]; ++z) voxels.setValue({x, y, z}, field(x, y, z));
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec3I> triangles;
  std::vector<openvdb::Vec4I> quads;
  openvdb::tools::volumeToMesh(*grid, points, triangles, quads, iso, 0.0, true);
  TriangleMesh mesh;
  std::vector<openvdb::Vec3d> in_index(points.begin(), points.end());
  for (const openvdb::Vec3d& p : in_index)
    mesh.vertices.push_back(world_from_index * Eigen::Vector3d(p[0], p[1], p[2]));
  mesh.faces = internal::Triangulate(in_index, triangles, quads);
  return mesh;
}

TriangleMesh MeshOfFunction(const Eigen::Vector3d& origin, double voxel, const Eigen::Vector3i& size,
                            const std::function<double(const Eigen::Vector3d&)>& value) {
  constexpr size_t kGrain = 256;
  Eigen::Affine3d world_from_index = Eigen::Affine3d::Identity();
  world_from_index.linear() *= voxel;
  world_from_index.translation() = origin;
  DenseField field;
  field.size = size;
  const auto rows = static_cast<size_t>(size[1]), columns = static_cast<size_t>(size[2]);
  field.values.resize(static_cast<size_t>(size[0]) * rows * columns);
  ParallelFor(field.values.size(), kGrain, [&](size_t i) {
    const size_t z = i % columns, y = i / columns % rows, x = i / columns / rows;
    field.values[i] = static_cast<float>(value(
        world_from_index * Eigen::Vector3d(static_cast<double>(x), static_cast<double>(y), static_cast<double>(z))));
  });
  return MeshOfField(field, world_from_index, 0);
}

}  // namespace glint
