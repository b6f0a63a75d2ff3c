#include "highlights/lamp_size.h"

#include <algorithm>
#include <cmath>

#include "core/median.h"
#include "core/square.h"
#include "highlights/lobe_profile.h"
#include "highlights/mirror_test.h"
#include "light/light_covariance.h"

namespace glint {
namespace {

constexpr size_t kFewestHighlights = 5;
constexpr double kCentroidShare = 0.05;  // of its size an extended lamp's middle is uncertain
constexpr double kLeastShare = 0.5;      // of a highlight's radius, by the lamp: less passes for gloss and noise

// Standard deviation of the mean of values, from their median absolute deviation.
double SigmaOfMean(const std::vector<double>& values) {
  const double middle = Median(values);
  std::vector<double> deviations;
  for (double value : values) deviations.push_back(std::abs(value - middle));
  return 1.4826 * Median(deviations) / std::sqrt(static_cast<double>(values.size()));
}

}  // namespace

double CentroidSigma(const std::vector<View>& views, const Eigen::Vector3d& center, const FoundLight& found) {
  const double sigma_deg = kCentroidShare * found.angular_size_deg;
  if (found.light.type == LightType::kDistant) return sigma_deg;
  double distance = 0;
  for (const View& view : views)
    distance += (found.light.vector - (found.light.frame == LightFrame::kWorld ? center : view.cam_from_world * center))
                    .norm() /
                static_cast<double>(views.size());
  return sigma_deg * M_PI / 180 * distance;
}

void MeasureSize(const Scene& scene, const SeedSurface& surface, const std::vector<Highlight>& highlights,
                 const Eigen::Vector3d& center, FoundLight& light) {
  std::vector<double> flatness, widths_deg;
  for (const Highlight& h : highlights) {
    if (h.flatness <= 0) continue;
    const View& view = scene.views[h.view];
    const auto ray = view.RayThrough(h.px);
    const auto at = ray ? surface.Meet(view.Center(), *ray) : std::nullopt;
    if (!at) continue;
    const double cos = std::max(0.0, -ray->dot(HalfVector(light.light, view.cam_from_world, at->position)));
    flatness.push_back(h.flatness);
    // Across the plane of incidence a lamp turns the half vector by 1 / cos more than in it.
    widths_deg.push_back(std::sqrt(cos) * MirrorTest(view, surface, light.light, h, *at).WidthDeg());
  }
  if (flatness.size() < kFewestHighlights) return;
  const double least = Median(flatness) - 3 * SigmaOfMean(flatness);
  if (DiscShare(least) < kLeastShare) return;
  // The half vector turns by half of what the light does: a lamp of radius r is a disc of r / 2 there.
  light.angular_size_deg = 4 * DiscShare(Median(flatness)) * Median(widths_deg);
  const double sigma = CentroidSigma(scene.views, center, light);
  if (light.light.type == LightType::kPoint)
    light.covariance += sigma * sigma * Eigen::Matrix3d::Identity();
  else
    light.covariance += Square(sigma * M_PI / 180) *
                        (Eigen::Matrix3d::Identity() - light.light.vector * light.light.vector.transpose());
  light.light.sigma = LargestSigma(light.covariance, light.light);
}

std::vector<double> WidthsDeg(const Scene& scene, const SeedSurface& surface, const std::vector<Highlight>& highlights,
                              const Light& light) {
  std::vector<double> widths_deg;
  for (const Highlight& h : highlights) {
    const View& view = scene.views[h.view];
    const auto ray = view.RayThrough(h.px);
    const auto at = ray ? surface.Meet(view.Center(), *ray) : std::nullopt;
    if (at) widths_deg.push_back(MirrorTest(view, surface, light, h, *at).WidthDeg());
  }
  return widths_deg;
}

}  // namespace glint
