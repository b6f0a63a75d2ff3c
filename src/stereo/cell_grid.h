// Cubic cells over a box, and the lattice of their centres, sides and corners. Only for .cc files of this module.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "geometry/triangle_mesh.h"

namespace glint::internal {

// Numbers of cells and of places run fastest along z, as in DenseField.
class CellGrid {
 public:
  // Cells `cell_size` wide, two more than the box needs on each side.
  CellGrid(const Eigen::AlignedBox3d& box, double cell_size);

  double cell_size() const { return cell_size_; }
  size_t num_cells() const { return Product(size_); }
  Eigen::Vector3d Center(uint32_t cell) const;
  std::optional<uint32_t> At(const Eigen::Vector3d& x) const;

  template <class Visit>
  void ForNeighbors(uint32_t cell, const Visit& visit) const {
    const std::array<int, 3> i = Index(cell, size_);
    for (int axis = 0; axis < 3; ++axis) {
      if (i[axis] > 0) visit(static_cast<uint32_t>(cell - Stride(size_, axis)));
      if (i[axis] + 1 < size_[axis]) visit(static_cast<uint32_t>(cell + Stride(size_, axis)));
    }
  }

  // Places half a cell apart.
  size_t num_places() const { return Product(lattice_); }
  Eigen::Vector3d PlaceAt(size_t place) const;
  // The cell's centre and those of its sides.
  std::array<size_t, 7> PlacesOf(uint32_t cell) const;

  // A binomial filter along each axis, of one value a cell.
  void Smooth(std::vector<float>& values) const;
  // Where the cells' values pass `level`, oriented toward the greater ones.
  TriangleMesh Mesh(std::vector<float> values, double level) const;

 private:
  using Size = std::array<int, 3>;
  static size_t Product(const Size& size) { return static_cast<size_t>(size[0]) * size[1] * size[2]; }
  static size_t Stride(const Size& size, int axis) {
    return axis == 2 ? 1 : axis == 1 ? size[2] : static_cast<size_t>(size[1]) * size[2];
  }
  static std::array<int, 3> Index(size_t i, const Size& size) {
    return {static_cast<int>(i / size[2] / size[1]), static_cast<int>(i / size[2] % size[1]),
            static_cast<int>(i % size[2])};
  }

  double cell_size_;
  Eigen::Vector3d origin_;
  Size size_, lattice_;
};

}  // namespace glint::internal
