#include "refine/band.h"

#include <openvdb/openvdb.h>

#include <algorithm>
#include <cmath>

#include "core/check.h"
#include "sdf/level_set_impl.h"

namespace glint {
namespace {

std::vector<Eigen::Vector3i> ActiveCoords(const openvdb::FloatTree& tree) {
  std::vector<Eigen::Vector3i> coords;
  coords.reserve(tree.activeLeafVoxelCount());
  for (auto leaf = tree.cbeginLeaf(); leaf; ++leaf)
    for (auto voxel = leaf->cbeginValueOn(); voxel; ++voxel) {
      const openvdb::Coord c = voxel.getCoord();
      coords.emplace_back(c.x(), c.y(), c.z());
    }
  return coords;
}

}  // namespace

Band::Band(const LevelSet& level_set) : BandTopology(ActiveCoords(level_set.impl().grid->tree())), source_(level_set) {
  const openvdb::FloatGrid& grid = *level_set.impl().grid;
  voxel_size_ = level_set.voxel_size();
  half_width_voxels_ = level_set.half_width_voxels();
  const openvdb::Vec3d origin = grid.indexToWorld(openvdb::Vec3d(0, 0, 0));
  origin_ = {origin.x(), origin.y(), origin.z()};
  phi_.reserve(size());
  for (auto leaf = grid.tree().cbeginLeaf(); leaf; ++leaf)
    for (auto voxel = leaf->cbeginValueOn(); voxel; ++voxel) phi_.push_back(*voxel);
}

bool Band::Trilinear(const Eigen::Vector3d& x_in_world, std::array<int32_t, 8>& voxels,
                     std::array<double, 8>& weights) const {
  const Eigen::Vector3d x = ToIndexSpace(x_in_world);
  const Eigen::Vector3d floor = x.array().floor();
  const Eigen::Vector3d f = x - floor;
  const Eigen::Vector3i base = floor.cast<int>();
  for (int k = 0; k < 8; ++k) {
    const Eigen::Vector3i offset(k & 1, (k >> 1) & 1, k >> 2);
    voxels[k] = Find(base + offset);
    if (voxels[k] == kNone) return false;
    double weight = 1;
    for (int axis = 0; axis < 3; ++axis) weight *= offset[axis] ? f[axis] : 1 - f[axis];
    weights[k] = weight;
  }
  return true;
}

LevelSet Band::WithValues(const std::vector<float>& phi) const {
  GLINT_CHECK_EQ(phi.size(), phi_.size());
  LevelSet result = source_.DeepCopy();
  openvdb::FloatTree& tree = result.impl().grid->tree();
  const float background = result.impl().grid->background();
  size_t i = 0;
  for (auto leaf = tree.beginLeaf(); leaf; ++leaf)
    for (auto voxel = leaf->beginValueOn(); voxel; ++voxel)
      voxel.setValue(std::clamp(phi[i++], -background, background));
  return result;
}

}  // namespace glint
