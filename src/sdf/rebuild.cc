#include "sdf/rebuild.h"

#include <fmt/format.h>

#include <cmath>

#include "core/error.h"
#include "sdf/extract_mesh.h"
#include "sdf/level_set_impl.h"
#include "sdf/mesh_to_level_set.h"

namespace glint {

namespace {

LevelSet Rebuild(const LevelSet& level_set, const Eigen::Affine3d& world_from_index, double half_width_voxels) {
  const TriangleMesh mesh = ExtractMesh(level_set);
  if (mesh.faces.empty()) throw InputError("", "level set", "expected a zero set, found none");
  return MeshToLevelSet(mesh, world_from_index, {.half_width_voxels = half_width_voxels, .sign = "pseudonormal"});
}

Eigen::Affine3d WorldFromIndex(const LevelSet& level_set) {
  Eigen::Affine3d world_from_index = Eigen::Affine3d::Identity();
  const auto matrix = level_set.impl().grid->transform().baseMap()->getAffineMap()->getMat4();
  for (int r = 0; r < 4; ++r)
    for (int c = 0; c < 4; ++c) world_from_index.matrix()(r, c) = matrix[c][r];  // OpenVDB multiplies row vectors
  return world_from_index;
}

}  // namespace

LevelSet Redistance(const LevelSet& level_set, double half_width_voxels) {
  if (level_set.empty()) throw InputError("", "level set", "expected a zero set, found none");
  return Rebuild(level_set, WorldFromIndex(level_set), half_width_voxels);
}

LevelSet Resample(const LevelSet& level_set, double new_voxel_size_world, double half_width_voxels) {
  if (!(new_voxel_size_world > 0) || !std::isfinite(new_voxel_size_world))
    throw InputError("", "voxel size", fmt::format("expected a positive length, found {}", new_voxel_size_world));
  if (level_set.empty()) throw InputError("", "level set", "expected a zero set, found none");
  Eigen::Affine3d world_from_index = WorldFromIndex(level_set);
  world_from_index.linear() *= new_voxel_size_world / level_set.voxel_size();
  return Rebuild(level_set, world_from_index, half_width_voxels);
}

}  // namespace glint
