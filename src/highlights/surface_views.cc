#include "highlights/surface_views.h"

#include <algorithm>

namespace glint {

namespace {
constexpr double kMarginRel = 1e-3;  // of the diagonal
}

SurfaceViews::SurfaceViews(const TriangleMesh& surface, const Scene& scene)
    : scene_(scene), caster_(surface), margin_world_(kMarginRel * Diagonal(surface)) {
  for (const View& view : scene.views) centers_.push_back(view.Center());
}

std::vector<SeenBy> SurfaceViews::Squarest(const Eigen::Vector3d& x, const Eigen::Vector3d& normal, double min_cosine,
                                           size_t max_views) const {
  std::vector<std::pair<double, uint32_t>> square;  // minus cosine, so that the squarest comes first
  for (uint32_t k = 0; k < centers_.size(); ++k) {
    const double cosine = (centers_[k] - x).normalized().dot(normal);
    if (cosine > min_cosine) square.emplace_back(-cosine, k);
  }
  std::sort(square.begin(), square.end());
  std::vector<SeenBy> seen;
  for (const auto& [minus_cosine, k] : square) {
    if (seen.size() >= max_views) break;
    const auto px = scene_.views[k].Project(x);
    if (!px || !scene_.views[k].Contains(*px) || caster_.Occluded(x, centers_[k], margin_world_)) continue;
    seen.push_back({k, px->cast<float>(), static_cast<float>(-minus_cosine)});
  }
  return seen;
}

}  // namespace glint
