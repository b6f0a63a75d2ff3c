#include "highlights/paint_test.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "highlights/mirror_test.h"

namespace glint {
namespace {

constexpr double kMaxViewAngleDeg = 72;  // between the seed's normal and a view that is compared with
constexpr int kMaxDepths = 81;
constexpr double kMaxStretch = 3;
constexpr size_t kEnoughViews = 6;
constexpr double kMinShading = 0.3;
constexpr double kDark = 0.3;     // of the rise
constexpr double kLarge = 3;      // map pixels
constexpr double kMiddle = 0.75;  // of the radius at half height

// How bright the light makes paint at the surface point in this view (Lambert), up to a constant; one if it stands
// still.
double Shading(const Light& light, const Rigid3d& cam_from_world, const SurfaceSample& at) {
  if (light.frame == LightFrame::kWorld) return 1;
  const double cos = std::max(0.0, at.normal.dot(DirectionToLight(light, cam_from_world, at.position)));
  if (light.type == LightType::kDistant) return cos;
  return cos / (cam_from_world.Inverse() * light.vector - at.position).squaredNorm();
}

Light MirroredAt(const SurfaceSample& at, const Eigen::Vector3d& to_camera) {
  return {LightType::kDistant, LightFrame::kWorld, (2 * at.normal.dot(to_camera) * at.normal - to_camera).normalized(),
          0};
}

struct OtherView {
  size_t view;
  double shading;  // relative to the highlight's own view, at most 1
};

// Views in which the surface point can be seen, the light is mirrored elsewhere and paint would still be bright.
std::vector<OtherView> ViewsToCompare(const Scene& scene, const ViewBrightness& brightness, const SeedSurface& surface,
                                      const Light& light, const Highlight& highlight, const SurfaceSample& at,
                                      double min_half_change_deg) {
  const View& own = scene.views[highlight.view];
  const Eigen::Vector3d own_half = HalfVector(light, own.cam_from_world, at.position);
  const double min_cos = std::cos(kMaxViewAngleDeg * M_PI / 180);
  const double max_half_cos = std::cos(min_half_change_deg * M_PI / 180);
  const double own_shading = Shading(light, own.cam_from_world, at);
  std::vector<std::pair<double, OtherView>> by_change;
  for (size_t j = 0; j < scene.views.size(); ++j) {
    const View& view = scene.views[j];
    if (j == highlight.view || !brightness.Has(j)) continue;
    const Eigen::Vector3d center = view.Center();
    if (at.normal.dot((center - at.position).normalized()) < min_cos) continue;
    const double half_cos = HalfVector(light, view.cam_from_world, at.position).dot(own_half);
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

// Pixels that a unit of length across the view's direction is wide.
double SizeAt(const View& view, const Eigen::Vector3d& x) {
  return MeanFocalLength(view.camera) / (view.Center() - x).norm();
}

}  // namespace

std::optional<double> KeptBrightness(const Scene& scene, const ViewBrightness& brightness, const SeedSurface& surface,
                                     const Light* known_light, const Highlight& highlight, const SurfaceSample& at,
                                     const PaintTestOptions& options) {
  const View& view = scene.views[highlight.view];
  const Light light = known_light ? *known_light : MirroredAt(at, (view.Center() - at.position).normalized());
  const MirrorTest mirror(view, surface, light, highlight, at);
  const auto views = ViewsToCompare(scene, brightness, surface, light, highlight, at,
                                    std::max(options.min_half_change_deg, mirror.DarkDeg()));
  const auto ray = view.RayThrough(highlight.px);
  if (static_cast<int>(views.size()) < options.min_other_views || !ray) return std::nullopt;

  const double pixel_size = brightness.PixelSize(highlight.view);
  const double minor_px =
      2 * std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(highlight.moments_px).eigenvalues()[0]);
  // Small blobs need some tolerance to be met again. Of large ones the mean over their middle is compared, in which
  // small marks that they are seen through count for little.
  const bool large = 0.5 * minor_px > kLarge * pixel_size;
  const double radius_px = large ? kMiddle * minor_px : std::max(0.5 * minor_px, 1.5 * pixel_size);
  const auto look = [&](size_t v, const Eigen::Vector2d& px, double size) {
    return large ? brightness.MeanNear(v, px, size * radius_px) : brightness.MaxNear(v, px, radius_px);
  };
  const auto peak = look(highlight.view, highlight.px, 1);
  const auto body = brightness.MedianAround(highlight.view, highlight.px, highlight.moments_px);
  if (!peak || !body || *peak - *body < 1e-3) return std::nullopt;

  // The rise over what is around the place in that view: gloss brightens all of it where one looks at it aslant.
  const auto rise = [&](const OtherView& other, const Eigen::Vector3d& place) -> std::optional<double> {
    const View& there = scene.views[other.view];
    const auto px = there.Project(place);
    const double size = SizeAt(there, place) / SizeAt(view, place);
    const auto value = px ? look(other.view, *px, size) : std::nullopt;
    if (!value) return std::nullopt;
    const double body_there = *body * other.shading;
    const double plain = (*value - body_there) / other.shading;
    // Paint would be bright: what is dark says so anyhow.
    if (plain < kDark * (*peak - *body)) return plain;
    const auto off_deg = mirror.OffDeg(there, *px);
    if (off_deg && *off_deg < mirror.DarkDeg()) return std::nullopt;
    const auto around = brightness.MedianAround(other.view, *px, size * size * highlight.moments_px);
    return (*value - std::max(around.value_or(body_there), body_there)) / other.shading;
  };
  double kept = 0;
  bool compared = false;
  std::vector<double> ratios;
  // An error across the surface is a longer one along a slanting ray.
  const double reach = at.error_world / std::max(-ray->dot(at.normal), 1 / kMaxStretch);
  for (const Eigen::Vector3d& place : PlacesAlongRay(scene, views, at, *ray, reach, 1.5 * radius_px)) {
    ratios.clear();
    for (const OtherView& other : views)
      if (const auto r = rise(other, place)) ratios.push_back(*r / (*peak - *body));
    if (static_cast<int>(ratios.size()) < options.min_other_views) continue;
    std::nth_element(ratios.begin(), ratios.begin() + ratios.size() / 2, ratios.end());
    kept = std::max(kept, ratios[ratios.size() / 2]);
    compared = true;
  }
  return compared ? std::optional<double>(kept) : std::nullopt;
}

}  // namespace glint
