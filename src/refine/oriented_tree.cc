#include "refine/oriented_tree.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/check.h"
#include "core/parallel.h"

namespace glint {
namespace {

constexpr size_t kLeaf = 16;                          // points, at most
constexpr double kSameSide = 0.94, kOtherSide = 0.5;  // cosines of 20 and 60 degrees
constexpr double kSlack = 1e-9;                       // radians, for rounding

double Angle(const Eigen::Vector3d& a, const Eigen::Vector3d& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

// The cone around all of these; everything if they have no mean.
template <class Cones>
void SetCone(const Cones& cones, OrientedTree::Node& node) {
  node.axis.setZero();
  for (const auto& [axis, spread] : cones) node.axis += axis;
  node.axis.normalize();
  node.spread = node.axis.isZero() ? M_PI : 0;
  for (const auto& [axis, spread] : cones) node.spread = std::max(node.spread, Angle(node.axis, axis) + spread);
}

}  // namespace

double FacingAlike(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::clamp((a.dot(b) - kOtherSide) / (kSameSide - kOtherSide), 0.0, 1.0);
}

bool OrientedTree::Node::FacesAway(const Eigen::Vector3d& normal) const {
  return std::acos(std::clamp(normal.dot(axis), -1.0, 1.0)) - spread > std::acos(kOtherSide) + kSlack;
}

std::vector<OrientedTree::Range> OrientedTree::Level(int level) const {
  std::vector<Range> ranges = {{0, 0, order_.size()}};
  for (int l = 0; l < level; ++l) {
    std::vector<Range> halves;
    for (const Range& range : ranges) {
      const auto [first, second] = range.Halves();
      halves.insert(halves.end(), {first, second});
    }
    ranges.swap(halves);
  }
  return ranges;
}

OrientedTree::OrientedTree(const std::vector<Eigen::Vector3d>& positions, const std::vector<Eigen::Vector3d>& normals)
    : order_(positions.size()) {
  GLINT_CHECK_EQ(positions.size(), normals.size());
  std::iota(order_.begin(), order_.end(), 0);
  int depth = 0;
  while ((order_.size() >> depth) > kLeaf) ++depth;
  nodes_.resize((size_t{2} << depth) - 1);
  // Down: boxes, and halves along their longest side. All leaves are on the last level.
  for (int level = 0; level <= depth; ++level) {
    const std::vector<Range> ranges = Level(level);
    ParallelFor(ranges.size(), 1, [&](size_t i) {
      const Range& range = ranges[i];
      const auto at = [&](size_t k) { return order_.begin() + static_cast<std::ptrdiff_t>(k); };
      Eigen::AlignedBox3d& box = nodes_[range.index].box;
      for (size_t k = range.begin; k < range.end; ++k) box.extend(positions[order_[k]]);
      if (IsLeaf(range)) return;
      Eigen::Index axis;
      box.sizes().maxCoeff(&axis);
      std::nth_element(at(range.begin), at(range.Middle()), at(range.end), [&](uint32_t a, uint32_t b) {
        const double x = positions[a][axis], y = positions[b][axis];
        return x != y ? x < y : a < b;
      });
    });
  }
  // Up: cones.
  for (int level = depth; level >= 0; --level) {
    const std::vector<Range> ranges = Level(level);
    ParallelFor(ranges.size(), 64, [&](size_t i) {
      const Range& range = ranges[i];
      Node& node = nodes_[range.index];
      std::vector<std::pair<Eigen::Vector3d, double>> cones;
      if (IsLeaf(range)) {
        for (size_t k = range.begin; k < range.end; ++k) cones.emplace_back(normals[order_[k]], 0);
      } else {
        const auto [first, second] = range.Halves();
        for (const Range& half : {first, second})
          cones.emplace_back(nodes_[half.index].axis, nodes_[half.index].spread);
      }
      SetCone(cones, node);
    });
  }
}

}  // namespace glint
