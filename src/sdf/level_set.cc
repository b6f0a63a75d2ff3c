#include "sdf/level_set.h"

#include <fmt/format.h>
#include <openvdb/tools/Interpolation.h>

#include <array>
#include <cmath>

#include "core/check.h"
#include "core/error.h"
#include "sdf/level_set_impl.h"

namespace glint {

namespace {

// Reads without registering with the tree: the tree does not change while a level set is queried.
using Accessor = openvdb::tree::ValueAccessor<const openvdb::FloatTree, false>;

double SampleIndex(const Accessor& accessor, const openvdb::Vec3d& x_in_index) {
  return openvdb::tools::BoxSampler::sample(accessor, x_in_index);
}

}  // namespace

LevelSet::LevelSet() = default;
LevelSet::LevelSet(std::shared_ptr<LevelSetImpl> impl) : impl_(std::move(impl)) {
  GLINT_CHECK(impl_ == nullptr || impl_->grid != nullptr);
}

bool LevelSet::empty() const { return impl_ == nullptr || impl_->grid->tree().empty(); }

double LevelSet::voxel_size() const { return impl_ ? impl_->grid->voxelSize()[0] : 0; }

double LevelSet::half_width_voxels() const { return impl_ ? impl_->grid->background() / voxel_size() : 0; }

size_t LevelSet::num_active_voxels() const { return impl_ ? impl_->grid->activeVoxelCount() : 0; }

size_t LevelSet::memory_bytes() const { return impl_ ? impl_->grid->memUsage() : 0; }

Eigen::AlignedBox3d LevelSet::ActiveBox() const {
  Eigen::AlignedBox3d box;
  if (empty()) return box;
  const openvdb::CoordBBox index_box = impl_->grid->evalActiveVoxelBoundingBox();
  if (index_box.empty()) return box;
  for (int corner = 0; corner < 8; ++corner) {
    openvdb::Vec3d x;
    for (int k = 0; k < 3; ++k) x[k] = (corner >> k & 1) ? index_box.max()[k] : index_box.min()[k];
    box.extend(FromVdb(impl_->grid->indexToWorld(x)));
  }
  return box;
}

double LevelSet::Value(const Eigen::Vector3d& x_in_world) const {
  GLINT_CHECK(impl_ != nullptr);
  const Accessor accessor(impl_->grid->tree());
  return SampleIndex(accessor, impl_->grid->worldToIndex(ToVdb(x_in_world)));
}

double LevelSet::MeanValue(const Eigen::Vector3d& x_in_world) const {
  GLINT_CHECK(impl_ != nullptr);
  const Accessor accessor(impl_->grid->tree());
  const openvdb::Vec3d x = impl_->grid->worldToIndex(ToVdb(x_in_world));
  const openvdb::Coord base = openvdb::Coord::floor(x);
  // 1 2 1 about each of the two voxels that linear interpolation takes.
  std::array<std::array<double, 4>, 3> weights;
  for (int axis = 0; axis < 3; ++axis) {
    const double f = x[axis] - base[axis];
    weights[axis] = {(1 - f) / 4, (2 - f) / 4, (1 + f) / 4, f / 4};
  }
  double sum = 0;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j)
      for (int k = 0; k < 4; ++k)
        sum += weights[0][i] * weights[1][j] * weights[2][k] * accessor.getValue(base.offsetBy(i - 1, j - 1, k - 1));
  return sum;
}

Eigen::Vector3d LevelSet::Gradient(const Eigen::Vector3d& x_in_world) const {
  GLINT_CHECK(impl_ != nullptr);
  const Accessor accessor(impl_->grid->tree());
  const openvdb::Vec3d x = impl_->grid->worldToIndex(ToVdb(x_in_world));
  openvdb::Vec3d in_index;
  for (int k = 0; k < 3; ++k) {
    openvdb::Vec3d step(0.0);
    step[k] = 1;
    in_index[k] = (SampleIndex(accessor, x + step) - SampleIndex(accessor, x - step)) / 2;
  }
  return FromVdb(impl_->grid->transform().baseMap()->applyIJT(in_index));
}

LevelSet LevelSet::DeepCopy() const { return impl_ ? MakeLevelSet(impl_->grid->deepCopy()) : LevelSet(); }

void RequireInBand(const LevelSet& level_set, double iso_world) {
  const float half_width_world = level_set.impl().grid->background();
  if (!(std::abs(iso_world) < half_width_world))
    throw InputError(
        "", "iso level",
        fmt::format("expected less than the half width of the band, {}, found {}", half_width_world, iso_world));
}

}  // namespace glint
