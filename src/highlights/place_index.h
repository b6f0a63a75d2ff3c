// Things in an image by where they are.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <vector>

namespace glint {

// Boxes in a grid of cells; pixels of the full image.
class PlaceIndex {
 public:
  PlaceIndex(int width_px, int height_px)
      : columns_(width_px / kCell + 1),
        rows_(height_px / kCell + 1),
        newest_(static_cast<size_t>(columns_) * static_cast<size_t>(rows_), -1) {}

  void Put(size_t id, const Eigen::Vector2d& center, const Eigen::Vector2d& half_size) {
    const Eigen::Vector2i low = CellAt(center - half_size), high = CellAt(center + half_size);
    for (int y = low.y(); y <= high.y(); ++y)
      for (int x = low.x(); x <= high.x(); ++x) {
        entries_.push_back({id, Newest(x, y)});
        newest_[Index(x, y)] = static_cast<int>(entries_.size()) - 1;
      }
  }

  // Calls visit(id) for whatever may cover the place, the latest first; some more than once.
  template <class Visit>
  void At(const Eigen::Vector2d& px, const Visit& visit) const {
    const Eigen::Vector2i cell = CellAt(px);
    for (int e = Newest(cell.x(), cell.y()); e >= 0; e = entries_[static_cast<size_t>(e)].older)
      visit(entries_[static_cast<size_t>(e)].id);
  }

 private:
  static constexpr int kCell = 32;
  struct Entry {
    size_t id;
    int older;  // of the same cell
  };

  size_t Index(int x, int y) const {
    return static_cast<size_t>(y) * static_cast<size_t>(columns_) + static_cast<size_t>(x);
  }
  int Newest(int x, int y) const { return newest_[Index(x, y)]; }
  Eigen::Vector2i CellAt(const Eigen::Vector2d& px) const {
    return {static_cast<int>(std::clamp(px.x() / kCell, 0.0, columns_ - 1.0)),
            static_cast<int>(std::clamp(px.y() / kCell, 0.0, rows_ - 1.0))};
  }

  int columns_, rows_;
  std::vector<int> newest_;
  std::vector<Entry> entries_;
};

}  // namespace glint
