#include "sdf/csg.h"

#include <openvdb/tools/Composite.h>

#include "sdf/extract_mesh.h"
#include "sdf/level_set_impl.h"
#include "sdf/mesh_to_level_set.h"

namespace glint {
namespace {

template <class Combine>
TriangleMesh Combined(const TriangleMesh& a, const TriangleMesh& b, double voxel_size_world, const Combine& combine) {
  const LevelSet first = MeshToLevelSet(a, voxel_size_world), second = MeshToLevelSet(b, voxel_size_world);
  return ExtractMesh(MakeLevelSet(combine(*first.impl().grid, *second.impl().grid)));
}

}  // namespace

TriangleMesh Union(const TriangleMesh& a, const TriangleMesh& b, double voxel_size_world) {
  return Combined(a, b, voxel_size_world, openvdb::tools::csgUnionCopy<openvdb::FloatGrid>);
}

TriangleMesh Difference(const TriangleMesh& a, const TriangleMesh& b, double voxel_size_world) {
  return Combined(a, b, voxel_size_world, openvdb::tools::csgDifferenceCopy<openvdb::FloatGrid>);
}

}  // namespace glint
