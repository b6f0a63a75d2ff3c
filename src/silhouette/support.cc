#include "silhouette/support.h"

#include <algorithm>
#include <cmath>

#include "core/median.h"

namespace glint {
namespace {

constexpr int kNeighbors = 48;
constexpr double kMinCosine = 0.866;

std::vector<Eigen::Vector3d> Places(const Scene& scene, const std::vector<OutlineSample>& outline) {
  std::vector<Eigen::Vector3d> places;
  for (const OutlineSample& s : outline) places.emplace_back(scene.views[s.view].Center() + s.depth * s.ray);
  return places;
}

}  // namespace

OutlineNeighbors::OutlineNeighbors(const Scene& scene, const std::vector<OutlineSample>& outline)
    : outline_(outline), places_(Places(scene, outline)), index_(places_) {}

Support OutlineNeighbors::Of(size_t sample, double reach) const {
  const Eigen::Vector3d& x = places_[sample];
  const OutlineSample& own = outline_[sample];
  Support out;
  std::vector<double> offsets;
  std::vector<uint32_t> views = {own.view};
  for (int j : index_.Nearest(x, kNeighbors)) {
    const OutlineSample& other = outline_[j];
    if ((places_[j] - x).norm() > reach) break;
    if (other.normal.dot(own.normal) < kMinCosine) continue;
    views.push_back(other.view);
    out.normal += other.normal;
    offsets.push_back((own.normal + other.normal).normalized().dot(places_[j] - x));
  }
  std::sort(views.begin(), views.end());
  out.views = std::unique(views.begin(), views.end()) - views.begin();
  out.samples = offsets.size();
  if (offsets.empty()) return out;
  out.normal.normalize();
  out.offset = Median(offsets);
  for (double& o : offsets) o = std::abs(o - out.offset);
  out.spread = 1.4826 * Median(offsets);
  return out;
}

}  // namespace glint
