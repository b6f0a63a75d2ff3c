#include "highlights/find_lights.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/check.h"
#include "core/parallel.h"
#include "highlights/paint_test.h"
#include "highlights/seed_surface.h"
#include "highlights/view_brightness.h"

namespace glint {
namespace {

constexpr double kMaxViewAngleDeg = 65;  // silhouettes catch the background
constexpr double kMinConditioning = 0.01;

// What goes dark at its place in the other views, whatever the light; indices into `candidates`.
std::vector<size_t> NotPaint(const Scene& scene, const ViewBrightness& brightness, const SeedSurface& surface,
                             const GateOptions& gate, const std::vector<Highlight>& candidates, Progress& progress) {
  std::vector<char> passed(candidates.size(), 0);
  progress.Begin("Highlights that move", candidates.size());
  ParallelFor(candidates.size(), 16, [&](size_t i) {
    progress.ThrowIfCancelled();
    progress.Advance();
    const Highlight& h = candidates[i];
    if (h.status != HighlightStatus::kAccepted) return;
    const auto ray = scene.views[h.view].RayThrough(h.px);
    if (!ray) return;
    const auto samples = surface.Neighbourhood(scene.views[h.view].Center(), *ray);
    if (samples.empty() || samples.front().off_center > 0 ||
        -ray->dot(samples.front().normal) < std::cos(kMaxViewAngleDeg * M_PI / 180))
      return;
    const auto kept = KeptBrightness(scene, brightness, surface, nullptr, h, samples.front(),
                                     {gate.min_half_change_deg, gate.min_other_views});
    passed[i] = kept && *kept <= gate.paint_ratio;
  });
  std::vector<size_t> indices;
  for (size_t i = 0; i < passed.size(); ++i)
    if (passed[i]) indices.push_back(i);
  return indices;
}

// The strongest, and none that is much fainter than they.
std::vector<size_t> Strongest(const std::vector<Highlight>& candidates, std::vector<size_t> indices,
                              double min_relative_strength, int max_candidates) {
  std::stable_sort(indices.begin(), indices.end(),
                   [&](size_t a, size_t b) { return candidates[a].strength > candidates[b].strength; });
  if (indices.empty()) return indices;
  const double least = min_relative_strength * candidates[indices[indices.size() / 10]].strength;
  while (candidates[indices.back()].strength < least) indices.pop_back();
  indices.resize(std::min(indices.size(), static_cast<size_t>(max_candidates)));
  std::sort(indices.begin(), indices.end());
  return indices;
}

std::vector<LightObservation> Observe(const Scene& scene, const SeedSurface& surface,
                                      const std::vector<Highlight>& candidates, const std::vector<size_t>& indices) {
  std::vector<LightObservation> observations;
  for (size_t i : indices) {
    const View& view = scene.views[candidates[i].view];
    // The seed's normal where the ray meets it: its neighbours' would fit almost any light.
    const SurfaceSample at = surface.Neighbourhood(view.Center(), *view.RayThrough(candidates[i].px)).front();
    observations.push_back({view.cam_from_world, at.position, at.normal});
  }
  return observations;
}

LightFitOptions FitOptions(const GateOptions& gate, const FindLightsOptions& options) {
  LightFitOptions fit;
  fit.max_lights = options.max_lights;
  fit.min_support = options.min_support;
  fit.max_incidence_deg = gate.max_incidence_deg + 5;
  fit.allow_distant = options.kinds != "point";
  fit.allow_point = options.kinds != "distant";
  return fit;
}

// Why a light is not to be used; empty: it is determined.
std::string WhyNot(const FoundLight& f, double diagonal, const FindLightsOptions& options) {
  const bool distant = f.light.type == LightType::kDistant;
  const double max_sigma = distant ? options.max_sigma_deg : options.max_sigma_deg * M_PI / 180 * 5 * diagonal;
  if (f.support < options.min_support) return fmt::format("only {:.1f} highlights point to it", f.support);
  if (f.light.sigma > max_sigma)
    return distant
               ? fmt::format("its direction is uncertain by {:.1f} deg", f.light.sigma)
               : fmt::format("its position is uncertain by {:.2g} diagonals of the object", f.light.sigma / diagonal);
  if (distant && f.conditioning < kMinConditioning) return "its highlights all have about the same normal";
  return "";
}

}  // namespace

void FindLightsOptions::Visit(OptionVisitor& v) {
  v.Field({.name = "max_lights", .help = "Most lights to look for", .unit = "lights", .min = 1, .max = 20}, max_lights);
  v.Field({.name = "min_support",
           .help = "Fewest highlights that make a light",
           .unit = "highlights",
           .min = 3,
           .max = 1000},
          min_support);
  v.Field({.name = "max_sigma_deg",
           .help = "A light that is less certain is not used",
           .unit = "deg",
           .min = 0.1,
           .max = 90},
          max_sigma_deg);
  v.Field({.name = "kinds", .help = "Kinds of lights to look for", .choices = {"any", "distant", "point"}}, kinds);
  v.Field({.name = "max_candidates",
           .help = "Only so many of the strongest candidates vote",
           .unit = "highlights",
           .min = 10,
           .max = 100000},
          max_candidates);
}

std::string FindLightsSummary::BriefReport() const {
  const auto used = std::count_if(lights.begin(), lights.end(), [](const FoundLight& f) { return f.determined; });
  std::string report = fmt::format("{} light{} found from {} of {} candidates that move", used, used == 1 ? "" : "s",
                                   not_paint, candidates);
  for (const FoundLight& f : lights) {
    const bool distant = f.light.type == LightType::kDistant;
    report += fmt::format("; {} in the {}'s frame ({:.3f}, {:.3f}, {:.3f}), {:.0f} highlights, sigma {:.2g}{}",
                          distant ? "distant" : "point", f.light.frame == LightFrame::kWorld ? "world" : "camera",
                          f.light.vector.x(), f.light.vector.y(), f.light.vector.z(), f.support, f.light.sigma,
                          distant ? " deg" : "");
    if (!f.determined) report += " is not determined and not used: " + f.why;
  }
  if (used > 0)
    report += fmt::format("; the seed's normals disagree by {:.1f} deg, {:.0f} % explained by no light",
                          normal_sigma_deg, 100 * outlier_share);
  return report;
}

std::vector<FoundLight> FindLights(const Scene& scene, const ImageSource& images, const TriangleMesh& seed,
                                   const GateOptions& gate, const FindLightsOptions& options,
                                   const std::vector<Highlight>& candidates, FindLightsSummary* summary,
                                   Progress& progress) {
  GLINT_CHECK_EQ(images.size(), scene.views.size());
  GLINT_CHECK(!seed.empty());
  const double diagonal = Diagonal(seed);
  const ViewBrightness brightness(images, size_t(gate.image_memory_mb) << 20, progress);
  const SeedSurface surface(seed, scene.points, gate.seed_error_rel * diagonal);
  FindLightsSummary told;
  for (const Highlight& h : candidates) told.candidates += h.status == HighlightStatus::kAccepted;

  std::vector<size_t> indices = NotPaint(scene, brightness, surface, gate, candidates, progress);
  told.not_paint = indices.size();
  indices = Strongest(candidates, std::move(indices), gate.min_relative_strength, options.max_candidates);
  const LightFit fit = FitLights(Observe(scene, surface, candidates, indices), BoundingBox(seed).center(), diagonal,
                                 FitOptions(gate, options));
  for (FoundLight f : fit.lights) {
    f.why = WhyNot(f, diagonal, options);
    f.determined = f.why.empty();
    told.lights.push_back(f);
  }
  std::stable_partition(told.lights.begin(), told.lights.end(), [](const FoundLight& f) { return f.determined; });
  told.normal_sigma_deg = fit.normal_sigma_deg;
  told.outlier_share = fit.outlier_share;
  if (summary) *summary = told;
  return told.lights;
}

}  // namespace glint
