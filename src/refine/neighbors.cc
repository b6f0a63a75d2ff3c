#include "refine/neighbors.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/check.h"
#include "core/parallel.h"
#include "refine/oriented_tree.h"

namespace glint {
namespace {

constexpr int kSectors = 6;

struct Candidate {
  double distance2;
  int index;
  bool operator<(const Candidate& other) const {
    return distance2 != other.distance2 ? distance2 < other.distance2 : index < other.index;
  }
};

// Two axes that span the plane across n.
std::pair<Eigen::Vector3d, Eigen::Vector3d> TangentAxes(const Eigen::Vector3d& n) {
  Eigen::Vector3d u = n.unitOrthogonal();
  return {u, n.cross(u)};
}

// The nearest targets of one query, by sectors. What it leaves out of a tree holds no target that would be taken.
class Search {
 public:
  Search(const Eigen::Vector3d& position, const Eigen::Vector3d& normal, const NeighborOptions& options)
      : position_(position),
        normal_(normal),
        axes_(TangentAxes(normal)),
        options_(options),
        min_cos_(std::cos(options.max_normal_angle)),
        max_sin_(std::sin(options.max_chord_angle)),
        per_sector_(std::max(1, (options.count + kSectors - 1) / kSectors)) {}

  bool LeavesOut(const OrientedTree::Node& node) const;
  void Visit(int index, const Eigen::Vector3d& position, const Eigen::Vector3d& normal);

  std::vector<int> Sorted() const {
    std::vector<int> found;
    for (const std::vector<Candidate>& heap : sectors_)
      for (const Candidate& candidate : heap) found.push_back(candidate.index);
    std::sort(found.begin(), found.end());
    return found;
  }

 private:
  // The direction of a chord in the tangent plane, in sectors from 0 to kSectors.
  double SectorOf(const Eigen::Vector3d& chord) const {
    const double angle = std::atan2(chord.dot(axes_.second), chord.dot(axes_.first)) + M_PI;
    return angle * kSectors / (2 * M_PI);
  }
  bool Takes(int sector, double distance2) const {
    return sectors_[sector].size() < per_sector_ || distance2 <= sectors_[sector].front().distance2;
  }

  const Eigen::Vector3d position_, normal_;
  const std::pair<Eigen::Vector3d, Eigen::Vector3d> axes_;
  const NeighborOptions options_;
  const double min_cos_, max_sin_;
  const size_t per_sector_;
  std::array<std::vector<Candidate>, kSectors> sectors_;  // each a heap of the nearest
};

bool Search::LeavesOut(const OrientedTree::Node& node) const {
  constexpr double kSlack = 1e-9;  // for rounding, relative or in radians
  const double off_axis = std::acos(std::clamp(normal_.dot(node.axis), -1.0, 1.0));
  if (off_axis - node.spread > options_.max_normal_angle + kSlack) return true;
  const double distance2 = (1 - kSlack) * node.box.squaredExteriorDistance(position_);
  const Eigen::Vector3d chord = node.box.center() - position_;
  const double radius = 0.5 * node.box.sizes().norm() * (1 + kSlack);
  const double across = std::hypot(chord.dot(axes_.first), chord.dot(axes_.second));
  const auto takes = [&](int sector) { return Takes(sector, distance2); };
  if (across <= radius * (1 + kSlack)) {  // all around
    for (int s = 0; s < kSectors; ++s)
      if (takes(s)) return false;
    return true;
  }
  const double half = std::asin(radius / across) * kSectors / (2 * M_PI) + kSlack, middle = SectorOf(chord);
  for (int s = static_cast<int>(std::floor(middle - half)); s <= static_cast<int>(std::floor(middle + half)); ++s)
    if (takes((s + kSectors) % kSectors)) return false;
  return true;
}

void Search::Visit(int index, const Eigen::Vector3d& position, const Eigen::Vector3d& normal) {
  if (normal_.dot(normal) < min_cos_) return;
  const Eigen::Vector3d chord = position - position_;
  const double distance2 = chord.squaredNorm();
  if (distance2 == 0) return;
  std::vector<Candidate>& heap = sectors_[std::min(kSectors - 1, static_cast<int>(SectorOf(chord)))];
  const Candidate candidate{distance2, index};
  if (heap.size() == per_sector_ && !(candidate < heap.front())) return;
  const Eigen::Vector3d mean_normal = (normal_ + normal).normalized();
  if (std::abs(mean_normal.dot(chord)) > max_sin_ * std::sqrt(distance2)) return;
  if (heap.size() == per_sector_) {
    std::pop_heap(heap.begin(), heap.end());
    heap.pop_back();
  }
  heap.push_back(candidate);
  std::push_heap(heap.begin(), heap.end());
}

}  // namespace

std::vector<std::vector<int>> SectorNeighbors(const std::vector<Eigen::Vector3d>& query_positions,
                                              const std::vector<Eigen::Vector3d>& query_normals,
                                              const std::vector<Eigen::Vector3d>& target_positions,
                                              const std::vector<Eigen::Vector3d>& target_normals,
                                              const NeighborOptions& options) {
  GLINT_CHECK_EQ(query_positions.size(), query_normals.size());
  const OrientedTree targets(target_positions, target_normals);
  std::vector<std::vector<int>> neighbors(query_positions.size());
  ParallelFor(query_positions.size(), 16, [&](size_t i) {
    Search search(query_positions[i], query_normals[i], options);
    targets.Walk(
        query_positions[i], [&](const OrientedTree::Node& node) { return search.LeavesOut(node); },
        [&](uint32_t j) { search.Visit(static_cast<int>(j), target_positions[j], target_normals[j]); });
    neighbors[i] = search.Sorted();
  });
  return neighbors;
}

std::vector<std::pair<int, int>> UniquePairs(const std::vector<std::vector<int>>& neighbors) {
  std::vector<std::pair<int, int>> pairs;
  for (size_t i = 0; i < neighbors.size(); ++i)
    for (int j : neighbors[i]) pairs.emplace_back(std::min<int>(i, j), std::max<int>(i, j));
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  return pairs;
}

}  // namespace glint
