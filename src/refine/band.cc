#include "refine/band.h"

#include <openvdb/openvdb.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/check.h"
#include "core/parallel.h"
#include "sdf/level_set_impl.h"

namespace glint {

struct Band::Index {
  openvdb::Int32Grid::Ptr grid;
};

Band::Band(const LevelSet& level_set) : source_(level_set), index_(std::make_unique<Index>()) {
  const openvdb::FloatGrid& grid = *level_set.impl().grid;
  voxel_size_ = level_set.voxel_size();
  half_width_voxels_ = level_set.half_width_voxels();
  const openvdb::Vec3d origin = grid.indexToWorld(openvdb::Vec3d(0, 0, 0));
  origin_ = {origin.x(), origin.y(), origin.z()};
  index_->grid = openvdb::Int32Grid::create(kNone);
  index_->grid->setTree(std::make_shared<openvdb::Int32Tree>(grid.tree(), kNone, openvdb::TopologyCopy()));
  openvdb::Int32Tree& tree = index_->grid->tree();
  const size_t num_voxels = grid.activeVoxelCount();
  GLINT_CHECK_LT(num_voxels, size_t{1} << 31);
  phi_.reserve(num_voxels);
  coords_.reserve(num_voxels);
  for (auto leaf = tree.beginLeaf(); leaf; ++leaf) {
    const auto* values = grid.tree().probeConstLeaf(leaf->origin());
    for (auto voxel = leaf->beginValueOn(); voxel; ++voxel) {
      const openvdb::Coord c = voxel.getCoord();
      voxel.setValue(static_cast<int32_t>(phi_.size()));
      coords_.emplace_back(c.x(), c.y(), c.z());
      phi_.push_back(values->getValue(voxel.pos()));
    }
  }
  neighbors_.resize(phi_.size());
  ParallelChunks(phi_.size(), 1 << 14, [&](size_t begin, size_t end) {
    openvdb::Int32Grid::ConstAccessor accessor = index_->grid->getConstAccessor();
    for (size_t i = begin; i < end; ++i)
      for (int axis = 0; axis < 3; ++axis)
        for (int side = 0; side < 2; ++side) {
          openvdb::Coord c(coords_[i][0], coords_[i][1], coords_[i][2]);
          c[axis] += side ? 1 : -1;
          neighbors_[i][2 * axis + side] = accessor.getValue(c);
        }
  });
}

Band::~Band() = default;

int32_t Band::Find(const Eigen::Vector3i& ijk) const {
  return index_->grid->tree().getValue(openvdb::Coord(ijk[0], ijk[1], ijk[2]));
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
  // The index grid was filled in this very order.
  for (auto leaf = tree.beginLeaf(); leaf; ++leaf)
    for (auto voxel = leaf->beginValueOn(); voxel; ++voxel)
      voxel.setValue(std::clamp(phi[i++], -background, background));
  return result;
}

}  // namespace glint
