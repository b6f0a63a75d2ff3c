#include "highlights/paint_test.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace glint {
namespace {

constexpr double kMaxViewAngleDeg = 72;  // between the seed's normal and a view that is compared with
constexpr int kMaxDepths = 81;
constexpr double kMaxStretch = 3;
constexpr size_t kEnoughViews = 6;
constexpr double kMinShading = 0.3;

// How bright the light makes paint at the surface point in this view (Lambert), up to a constant; one if it stands
// still.
double Shading(const Light* light, const Rigid3d& cam_from_world, const SurfaceSample& at) {
  if (!light || light->frame == LightFrame::kWorld) return 1;
  const double cos = std::max(0.0, at.normal.dot(DirectionToLight(*light, cam_from_world, at.position)));
  if (light->type == LightType::kDistant) return cos;
  return cos / (cam_from_world.Inverse() * light->vector - at.position).squaredNorm();
}

struct OtherView {
  size_t view;
  double shading;  // relative to the highlight's own view, at most 1
};

// Views in which the surface point can be seen, the light is mirrored elsewhere and paint would still be bright.
std::vector<OtherView> ViewsToCompare(const Scene& scene, const ViewBrightness& brightness, const SeedSurface& surface,
                                      const Light* light, const Highlight& highlight, const SurfaceSample& at,
                                      double min_half_change_deg) {
  const View& own = scene.views[highlight.view];
  const Eigen::Vector3d own_view = (own.Center() - at.position).normalized();
  const Eigen::Vector3d own_half =
      light ? HalfVector(*light, own.cam_from_world, at.position) : Eigen::Vector3d::Zero();
  const double min_cos = std::cos(kMaxViewAngleDeg * M_PI / 180);
  const double max_half_cos = std::cos(min_half_change_deg * M_PI / 180);
  const double own_shading = Shading(light, own.cam_from_world, at);
  std::vector<std::pair<double, OtherView>> by_change;
  for (size_t j = 0; j < scene.views.size(); ++j) {
    const View& view = scene.views[j];
    if (j == highlight.view || !brightness.Has(j)) continue;
    const Eigen::Vector3d center = view.Center();
    if (at.normal.dot((center - at.position).normalized()) < min_cos) continue;
    const double view_cos = std::clamp(own_view.dot((center - at.position).normalized()), -1.0, 1.0);
    const double half_cos = light ? HalfVector(*light, view.cam_from_world, at.position).dot(own_half)
                                  : std::sqrt(0.5 * (1 + view_cos));  // the cosine of half the angle
    if (half_cos > max_half_cos) continue;
    const auto px = view.Project(at.position);
    if (!px || !view.Contains(*px) || surface.Occluded(at, center)) continue;
    const double shading = std::min(1.0, Shading(light, view.cam_from_world, at) / std::max(own_shading, 1e-12));
    if (shading < kMinShading) continue;
    by_change.push_back({half_cos, {j, shading}});
  }
  // Seen from about the same side a highlight on a round surface stays at its virtual image, as if it were paint
  // a little behind the surface: the views farthest round tell best.
  std::stable_sort(by_change.begin(), by_change.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  if (by_change.size() > kEnoughViews) by_change.resize(std::max(kEnoughViews, by_change.size() / 2));
  std::vector<OtherView> views;
  for (const auto& [half_cos, other] : by_change) views.push_back(other);
  return views;
}

// Depth offsets along the ray within the seed's error, fine enough that no view skips more than `step_px`.
std::vector<Eigen::Vector3d> PlacesAlongRay(const Scene& scene, const std::vector<OtherView>& views,
                                            const SurfaceSample& at, const Eigen::Vector3d& direction, double reach,
                                            double step_px) {
  double widest = 0;
  for (const OtherView& other : views) {
    const auto near = scene.views[other.view].Project(at.position - reach * direction);
    const auto far = scene.views[other.view].Project(at.position + reach * direction);
    if (near && far) widest = std::max(widest, (*far - *near).norm());
  }
  const int half_count = std::clamp(static_cast<int>(std::ceil(0.5 * widest / step_px)), 1, kMaxDepths / 2);
  std::vector<Eigen::Vector3d> places;
  for (int k = -half_count; k <= half_count; ++k) places.push_back(at.position + reach * k / half_count * direction);
  return places;
}

}  // namespace

std::optional<double> KeptBrightness(const Scene& scene, const ViewBrightness& brightness, const SeedSurface& surface,
                                     const Light* light, const Highlight& highlight, const SurfaceSample& at,
                                     const PaintTestOptions& options) {
  const View& view = scene.views[highlight.view];
  const auto views = ViewsToCompare(scene, brightness, surface, light, highlight, at, options.min_half_change_deg);
  const auto ray = view.RayThrough(highlight.px);
  if (static_cast<int>(views.size()) < options.min_other_views || !ray) return std::nullopt;

  const double pixel_size = brightness.PixelSize(highlight.view);
  const double minor_px =
      2 * std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(highlight.moments_px).eigenvalues()[0]);
  // Small blobs need some tolerance to be met again; large ones are met anyway, and a wide window would catch marks.
  const double radius_px = pixel_size * std::clamp(0.5 * minor_px / pixel_size, 1.5, 3.0);
  const auto peak = brightness.MaxNear(highlight.view, highlight.px, radius_px);
  const auto body = brightness.MedianAround(highlight.view, highlight.px, highlight.moments_px);
  if (!peak || !body || *peak - *body < 1e-3) return std::nullopt;

  double kept = 0;
  bool compared = false;
  std::vector<double> ratios;
  // An error across the surface is a longer one along a slanting ray.
  const double reach = at.error_world / std::max(-ray->dot(at.normal), 1 / kMaxStretch);
  for (const Eigen::Vector3d& place : PlacesAlongRay(scene, views, at, *ray, reach, 1.5 * radius_px)) {
    ratios.clear();
    for (const auto& [j, shading] : views) {
      const auto px = scene.views[j].Project(place);
      const auto value = px ? brightness.MaxNear(j, *px, radius_px) : std::nullopt;
      if (value) ratios.push_back((*value / shading - *body) / (*peak - *body));
    }
    if (static_cast<int>(ratios.size()) < options.min_other_views) continue;
    std::nth_element(ratios.begin(), ratios.begin() + ratios.size() / 2, ratios.end());
    kept = std::max(kept, ratios[ratios.size() / 2]);
    compared = true;
  }
  return compared ? std::optional<double>(kept) : std::nullopt;
}

}  // namespace glint
