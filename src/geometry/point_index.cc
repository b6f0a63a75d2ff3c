#include "geometry/point_index.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>
#include <utility>

namespace glint {
namespace {
constexpr int kLeaf = 8;
}

// The best so far, a max-heap by (squared distance, index).
struct PointIndex::Candidates {
  size_t count;
  std::vector<std::pair<double, int>> heap;

  bool Wants(double squared) const { return heap.size() < count || squared <= heap.front().first; }
  void Offer(double squared, int index) {
    heap.emplace_back(squared, index);
    std::push_heap(heap.begin(), heap.end());
    if (heap.size() > count) {
      std::pop_heap(heap.begin(), heap.end());
      heap.pop_back();
    }
  }
};

PointIndex::PointIndex(std::vector<Eigen::Vector3d> points)
    : points_(std::move(points)), order_(points_.size()), axis_(points_.size(), 0) {
  std::iota(order_.begin(), order_.end(), 0);
  Build(0, static_cast<int>(order_.size()));
}

void PointIndex::Build(int begin, int end) {
  if (end - begin <= kLeaf) return;
  Eigen::AlignedBox3d box;
  for (int i = begin; i < end; ++i) box.extend(points_[order_[i]]);
  int axis;
  box.sizes().maxCoeff(&axis);
  const int middle = (begin + end) / 2;
  std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                   [&](int a, int b) { return std::pair(points_[a][axis], a) < std::pair(points_[b][axis], b); });
  axis_[middle] = axis;
  Build(begin, middle);
  Build(middle + 1, end);
}

void PointIndex::Search(int begin, int end, const Eigen::Vector3d& x, Candidates& best) const {
  if (end - begin <= kLeaf) {
    for (int i = begin; i < end; ++i) best.Offer((points_[order_[i]] - x).squaredNorm(), order_[i]);
    return;
  }
  const int middle = (begin + end) / 2;
  best.Offer((points_[order_[middle]] - x).squaredNorm(), order_[middle]);
  const double beyond = x[axis_[middle]] - points_[order_[middle]][axis_[middle]];
  if (beyond < 0) {
    Search(begin, middle, x, best);
    if (best.Wants(beyond * beyond)) Search(middle + 1, end, x, best);
  } else {
    Search(middle + 1, end, x, best);
    if (best.Wants(beyond * beyond)) Search(begin, middle, x, best);
  }
}

std::vector<int> PointIndex::Nearest(const Eigen::Vector3d& x, int count) const {
  Candidates best{static_cast<size_t>(std::max(count, 0)), {}};
  if (count <= 0) return {};
  Search(0, static_cast<int>(order_.size()), x, best);
  std::sort_heap(best.heap.begin(), best.heap.end());
  std::vector<int> indices;
  for (const auto& [squared, index] : best.heap) indices.push_back(index);
  return indices;
}

}  // namespace glint
