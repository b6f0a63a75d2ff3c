#include "refine/neighbors.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/check.h"
#include "core/parallel.h"

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

}  // namespace

std::vector<std::vector<int>> SectorNeighbors(const std::vector<Eigen::Vector3d>& query_positions,
                                              const std::vector<Eigen::Vector3d>& query_normals,
                                              const std::vector<Eigen::Vector3d>& target_positions,
                                              const std::vector<Eigen::Vector3d>& target_normals,
                                              const NeighborOptions& options) {
  GLINT_CHECK_EQ(query_positions.size(), query_normals.size());
  GLINT_CHECK_EQ(target_positions.size(), target_normals.size());
  const double min_cos = std::cos(options.max_normal_angle), max_sin = std::sin(options.max_chord_angle);
  const size_t per_sector = std::max(1, (options.count + kSectors - 1) / kSectors);
  std::vector<std::vector<int>> neighbors(query_positions.size());
  ParallelFor(query_positions.size(), 16, [&](size_t i) {
    const auto [u, v] = TangentAxes(query_normals[i]);
    std::array<std::vector<Candidate>, kSectors> sectors;  // each a heap of the nearest
    for (size_t j = 0; j < target_positions.size(); ++j) {
      if (query_normals[i].dot(target_normals[j]) < min_cos) continue;
      const Eigen::Vector3d chord = target_positions[j] - query_positions[i];
      const double distance2 = chord.squaredNorm();
      if (distance2 == 0) continue;
      const double angle = std::atan2(chord.dot(v), chord.dot(u)) + M_PI;
      std::vector<Candidate>& heap = sectors[std::min(kSectors - 1, static_cast<int>(angle * kSectors / (2 * M_PI)))];
      const Candidate candidate{distance2, static_cast<int>(j)};
      if (heap.size() == per_sector && !(candidate < heap.front())) continue;
      const Eigen::Vector3d mean_normal = (query_normals[i] + target_normals[j]).normalized();
      if (std::abs(mean_normal.dot(chord)) > max_sin * std::sqrt(distance2)) continue;
      if (heap.size() == per_sector) {
        std::pop_heap(heap.begin(), heap.end());
        heap.pop_back();
      }
      heap.push_back(candidate);
      std::push_heap(heap.begin(), heap.end());
    }
    for (const std::vector<Candidate>& heap : sectors)
      for (const Candidate& candidate : heap) neighbors[i].push_back(candidate.index);
    std::sort(neighbors[i].begin(), neighbors[i].end());
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
