#include "highlights/find_lights.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/check.h"
#include "core/parallel.h"
#include "highlights/check_lights.h"
#include "highlights/paint_test.h"
#include "highlights/seed_surface.h"
#include "highlights/view_brightness.h"

namespace glint {
namespace {

constexpr double kMaxViewAngleDeg = 65;  // silhouettes catch the background
constexpr int kPasses = 2;
constexpr double kMinConditioning = 0.01;
constexpr double kMirrorsDeg = 6;     // of a place's normal: it would show the light
constexpr double kOneSpotRel = 0.01;  // spread of highlights that share one place's error, diagonals
constexpr double kClearRel = 0.01;    // how far the seed may be off where it hides things from each other, diagonals

struct Moving {
  size_t candidate;
  bool may_move;  // no paint either if a light moved with the camera and so shaded paint anew in every view
};

// What goes dark at its place in the other views. `moving_lights`: to try for lights that move with the camera.
std::vector<Moving> NotPaint(const Scene& scene, const ViewBrightness& brightness, const SeedSurface& surface,
                             const GateOptions& gate, const std::vector<Highlight>& candidates,
                             const std::vector<Light>& moving_lights, Progress& progress) {
  std::vector<std::array<bool, 2>> passed(candidates.size(), {false, false});
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
    const auto moves = [&](const Light* light) {
      const auto kept = KeptBrightness(scene, brightness, surface, light, h, samples.front(),
                                       {gate.min_half_change_deg, gate.min_other_views});
      return kept && *kept <= gate.paint_ratio;
    };
    passed[i][0] = moves(nullptr);
    passed[i][1] = passed[i][0] && std::all_of(moving_lights.begin(), moving_lights.end(),
                                               [&](const Light& light) { return moves(&light); });
  });
  std::vector<Moving> moving;
  for (size_t i = 0; i < passed.size(); ++i)
    if (passed[i][0]) moving.push_back({i, passed[i][1]});
  return moving;
}

// The strongest, and none that is much fainter than they; in the order of the candidates.
std::vector<Moving> Strongest(const std::vector<Highlight>& candidates, std::vector<Moving> moving,
                              double min_relative_strength, int max_candidates) {
  const auto strength = [&](const Moving& m) { return candidates[m.candidate].strength; };
  std::stable_sort(moving.begin(), moving.end(),
                   [&](const Moving& a, const Moving& b) { return strength(a) > strength(b); });
  if (moving.empty()) return moving;
  const double least = min_relative_strength * strength(moving[moving.size() / 10]);
  while (strength(moving.back()) < least) moving.pop_back();
  moving.resize(std::min(moving.size(), static_cast<size_t>(max_candidates)));
  std::sort(moving.begin(), moving.end(), [](const Moving& a, const Moving& b) { return a.candidate < b.candidate; });
  return moving;
}

std::vector<LightObservation> Observe(const Scene& scene, const SeedSurface& surface,
                                      const std::vector<Highlight>& candidates, const std::vector<Moving>& moving) {
  std::vector<LightObservation> observations;
  for (const Moving& m : moving) {
    const Highlight& h = candidates[m.candidate];
    const View& view = scene.views[h.view];
    // The seed's normal where the ray meets it: its neighbours' would fit almost any light.
    const SurfaceSample at = surface.Neighbourhood(view.Center(), *view.RayThrough(h.px)).front();
    observations.push_back({view.cam_from_world, at.position, at.normal, m.may_move});
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

// Root mean square distance of the light's highlights on the surface from their middle.
double Spread(const std::vector<LightObservation>& observations, const std::vector<int>& assignment, int light) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  double count = 0, squares = 0;
  for (size_t i = 0; i < observations.size(); ++i)
    if (assignment[i] == light) mean += observations[i].position, ++count;
  if (count == 0) return 0;
  mean /= count;
  for (size_t i = 0; i < observations.size(); ++i)
    if (assignment[i] == light) squares += (observations[i].position - mean).squaredNorm();
  return std::sqrt(squares / count);
}

// Views in which the seed has a place that would mirror the light to the camera and sees both.
int ViewsThatShouldShow(const Scene& scene, const SeedSurface& surface, const TriangleMesh& seed,
                        const std::vector<Eigen::Vector3d>& normals, const Light& light, double max_incidence_deg) {
  constexpr size_t kMaxPlaces = 3000;
  const double min_cos = std::cos(max_incidence_deg * M_PI / 180), near_cos = std::cos(kMirrorsDeg * M_PI / 180);
  const size_t stride = seed.vertices.size() / kMaxPlaces + 1;
  std::vector<char> shows(scene.views.size(), 0);
  ParallelFor(scene.views.size(), 1, [&](size_t v) {
    const View& view = scene.views[v];
    const Eigen::Vector3d center = view.Center();
    for (size_t i = 0; i < seed.vertices.size() && !shows[v]; i += stride) {
      const Eigen::Vector3d& x = seed.vertices[i];
      const Eigen::Vector3d half = HalfVector(light, view.cam_from_world, x);
      if (half.dot(normals[i]) < near_cos || half.dot((center - x).normalized()) < min_cos) continue;
      const auto px = view.Project(x);
      SurfaceSample at{x, normals[i]};
      at.error_world = kClearRel * surface.diagonal();
      const Eigen::Vector3d lamp = x + 2 * surface.diagonal() * DirectionToLight(light, view.cam_from_world, x);
      shows[v] = px && view.Contains(*px) && !surface.Occluded(at, center) && !surface.Occluded(at, lamp);
    }
  });
  return static_cast<int>(std::count(shows.begin(), shows.end(), 1));
}

// Why a light is not to be used; empty: it is determined.
std::string WhyNot(const FoundLight& f, int expected_views, double diagonal, const FindLightsOptions& options) {
  const bool distant = f.light.type == LightType::kDistant;
  const double max_sigma = distant ? options.max_sigma_deg : options.max_sigma_deg * M_PI / 180 * 5 * diagonal;
  if (f.support < options.min_support) return fmt::format("only {:.1f} highlights point to it", f.support);
  if (f.light.sigma > max_sigma)
    return distant
               ? fmt::format("its direction is uncertain by {:.1f} deg", f.light.sigma)
               : fmt::format("its position is uncertain by {:.2g} diagonals of the object", f.light.sigma / diagonal);
  if (distant && f.conditioning < kMinConditioning) return "its highlights all have about the same normal";
  if (f.normal_sigma_deg > options.max_normal_sigma_deg)
    return fmt::format("the surface's normals agree with it to {:.1f} deg only", f.normal_sigma_deg);
  if (f.support < options.min_completeness * expected_views)
    return fmt::format("only {:.0f} highlights point to it, and {} views should show it", f.support, expected_views);
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
  v.Field({.name = "min_completeness",
           .help = "Least highlights of a light, as a share of the views that should show one",
           .unit = "ratio",
           .min = 0,
           .max = 1},
          min_completeness);
  v.Field(
      {.name = "max_normal_sigma_deg",
       .help = "A light that the seed's normals agree with no better is not used: print agrees with any light a little",
       .unit = "deg",
       .min = 0.1,
       .max = 90},
      max_normal_sigma_deg);
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
    report += fmt::format(
        "; {} in the {}'s frame ({:.3f}, {:.3f}, {:.3f}), {:.0f} highlights, sigma {:.2g}{}, normals within {:.1f} deg",
        distant ? "distant" : "point", f.light.frame == LightFrame::kWorld ? "world" : "camera", f.light.vector.x(),
        f.light.vector.y(), f.light.vector.z(), f.support, f.light.sigma, distant ? " deg" : "", f.normal_sigma_deg);
    if (!f.determined) report += " is not determined and not used: " + f.why;
  }
  if (used > 0) report += fmt::format("; {:.0f} % explained by no light", 100 * outlier_share);
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

  // A light that moves with the camera is first taken for a flash; what it really is says better how it shades paint.
  std::vector<Light> moving_lights = {{LightType::kPoint, LightFrame::kCamera, Eigen::Vector3d::Zero(), 0}};
  LightFit fit;
  std::vector<LightObservation> observations;
  for (int pass = 0; pass < kPasses; ++pass) {
    std::vector<Moving> moving = NotPaint(scene, brightness, surface, gate, candidates, moving_lights, progress);
    told.not_paint = moving.size();
    moving = Strongest(candidates, std::move(moving), gate.min_relative_strength, options.max_candidates);
    observations = Observe(scene, surface, candidates, moving);
    fit = FitLights(observations, BoundingBox(seed).center(), diagonal, FitOptions(gate, options));
    moving_lights.resize(1);
    for (const FoundLight& f : fit.lights)
      if (f.light.frame == LightFrame::kCamera) moving_lights.push_back(f.light);
    if (moving_lights.size() == 1) break;
  }
  const std::vector<Eigen::Vector3d> normals = SmoothNormals(seed);
  for (size_t k = 0; k < fit.lights.size(); ++k) {
    FoundLight f = fit.lights[k];
    const int expected = ViewsThatShouldShow(scene, surface, seed, normals, f.light, gate.max_incidence_deg);
    if (InsideObject(f.light, seed))
      f.why = "it would lie inside the object";
    else if (Spread(observations, fit.assignment, static_cast<int>(k)) < kOneSpotRel * diagonal)
      f.why = "its highlights are all on one spot";
    else
      f.why = WhyNot(f, expected, diagonal, options);
    f.determined = f.why.empty();
    told.lights.push_back(f);
  }
  std::stable_partition(told.lights.begin(), told.lights.end(), [](const FoundLight& f) { return f.determined; });
  told.outlier_share = fit.outlier_share;
  if (summary) *summary = told;
  return told.lights;
}

}  // namespace glint
