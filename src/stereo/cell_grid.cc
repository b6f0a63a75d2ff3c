#include "stereo/cell_grid.h"

#include <cmath>
#include <utility>

#include "core/parallel.h"
#include "sdf/field_mesh.h"

namespace glint::internal {

CellGrid::CellGrid(const Eigen::AlignedBox3d& box, double cell_size)
    : cell_size_(cell_size), origin_(box.min() - Eigen::Vector3d::Constant(2 * cell_size)) {
  for (int a = 0; a < 3; ++a) {
    size_[a] = static_cast<int>(std::ceil(box.sizes()[a] / cell_size)) + 4;
    lattice_[a] = 2 * size_[a] + 1;
  }
}

Eigen::Vector3d CellGrid::Center(uint32_t cell) const {
  const std::array<int, 3> i = Index(cell, size_);
  return origin_ + cell_size_ * Eigen::Vector3d(i[0] + 0.5, i[1] + 0.5, i[2] + 0.5);
}

std::optional<uint32_t> CellGrid::At(const Eigen::Vector3d& x) const {
  size_t cell = 0;
  for (int a = 0; a < 3; ++a) {
    const int i = static_cast<int>(std::floor((x[a] - origin_[a]) / cell_size_));
    if (i < 0 || i >= size_[a]) return std::nullopt;
    cell = cell * size_[a] + i;
  }
  return static_cast<uint32_t>(cell);
}

Eigen::Vector3d CellGrid::PlaceAt(size_t place) const {
  const std::array<int, 3> i = Index(place, lattice_);
  return origin_ + cell_size_ / 2 * Eigen::Vector3d(i[0], i[1], i[2]);
}

std::array<size_t, 7> CellGrid::PlacesOf(uint32_t cell) const {
  const std::array<int, 3> i = Index(cell, size_);
  const size_t dx = Stride(lattice_, 0), dy = Stride(lattice_, 1), dz = 1;
  const size_t middle = (2 * i[0] + 1) * dx + (2 * i[1] + 1) * dy + (2 * i[2] + 1) * dz;
  return {middle, middle - dx, middle + dx, middle - dy, middle + dy, middle - dz, middle + dz};
}

void CellGrid::Smooth(std::vector<float>& values) const {
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<float> out = values;
    const size_t stride = Stride(size_, axis);
    ParallelFor(values.size(), 1 << 14, [&](size_t c) {
      const int i = Index(c, size_)[axis];
      if (i > 0 && i + 1 < size_[axis])
        out[c] = 0.25F * values[c - stride] + 0.5F * values[c] + 0.25F * values[c + stride];
    });
    values = std::move(out);
  }
}

TriangleMesh CellGrid::Mesh(std::vector<float> values, double level) const {
  const DenseField field{{size_[0], size_[1], size_[2]}, std::move(values)};
  Eigen::Affine3d world_from_index = Eigen::Affine3d::Identity();
  world_from_index.linear() *= cell_size_;
  world_from_index.translation() = origin_ + Eigen::Vector3d::Constant(cell_size_ / 2);
  return MeshOfField(field, world_from_index, level);
}

}  // namespace glint::internal
