#include "seed/clusters.h"

#include <algorithm>
#include <map>
#include <numeric>

#include "core/median.h"
#include "core/parallel.h"
#include "geometry/point_index.h"

namespace glint {
namespace {

constexpr int kNeighbors = 12;    // that a point may be linked to
constexpr int kSpacing = 4;       // which neighbour's distance is the spacing
constexpr double kReach = 2;      // spacings
constexpr double kMost = 0.8;     // of the points: a largest cluster with fewer is but a part of the object
constexpr double kOutside = 1.3;  // times the radius of the largest cluster
constexpr size_t kGrain = 64;

class Sets {
 public:
  explicit Sets(size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0); }
  int Find(int i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void Join(int i, int j) { parent_[std::max(Find(i), Find(j))] = std::min(Find(i), Find(j)); }

 private:
  std::vector<int> parent_;
};

}  // namespace

std::vector<int> DenseClusters(const std::vector<Eigen::Vector3d>& points, double reach) {
  const size_t n = points.size();
  if (n <= kSpacing) return std::vector<int>(n, 0);
  const PointIndex index(points);
  std::vector<std::vector<int>> nearest(n);
  std::vector<double> spacing(n);
  ParallelFor(n, kGrain, [&](size_t i) {
    nearest[i] = index.Nearest(points[i], std::min<int>(kNeighbors + 1, static_cast<int>(n)));
    spacing[i] = (points[nearest[i][kSpacing]] - points[i]).norm();  // the first is the point itself
  });
  Sets sets(n);
  for (size_t i = 0; i < n; ++i)
    for (const int j : nearest[i])
      if ((points[i] - points[j]).norm() <= reach * std::min(spacing[i], spacing[j])) sets.Join(static_cast<int>(i), j);
  std::map<int, size_t> size;
  for (size_t i = 0; i < n; ++i) ++size[sets.Find(static_cast<int>(i))];
  std::vector<std::pair<size_t, int>> order;
  for (const auto& [set, count] : size) order.emplace_back(count, -set);  // of equal ones the first
  std::sort(order.rbegin(), order.rend());
  std::map<int, int> number;
  for (const auto& [count, minus_set] : order) number.emplace(-minus_set, static_cast<int>(number.size()));
  std::vector<int> cluster(n);
  for (size_t i = 0; i < n; ++i) cluster[i] = number[sets.Find(static_cast<int>(i))];
  return cluster;
}

std::vector<uint8_t> LieApart(const std::vector<Eigen::Vector3d>& points) {
  std::vector<uint8_t> apart(points.size(), 0);
  const std::vector<int> cluster = DenseClusters(points, kReach);
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  for (int k = 0; k < 3; ++k) {
    std::vector<double> values;
    for (size_t i = 0; i < points.size(); ++i)
      if (cluster[i] == 0) values.push_back(points[i][k]);
    center[k] = Median(std::move(values));
  }
  std::vector<double> radii;
  for (size_t i = 0; i < points.size(); ++i)
    if (cluster[i] == 0) radii.push_back((points[i] - center).norm());
  if (radii.empty() || static_cast<double>(radii.size()) < kMost * static_cast<double>(points.size())) return apart;
  const auto most = radii.begin() + static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(radii.size() - 1));
  std::nth_element(radii.begin(), most, radii.end());
  std::map<int, double> nearest;  // of each cluster
  for (size_t i = 0; i < points.size(); ++i) {
    const double radius = (points[i] - center).norm();
    const auto [entry, is_new] = nearest.emplace(cluster[i], radius);
    if (!is_new) entry->second = std::min(entry->second, radius);
  }
  for (size_t i = 0; i < points.size(); ++i) apart[i] = cluster[i] != 0 && nearest[cluster[i]] > kOutside * *most;
  return apart;
}

}  // namespace glint
