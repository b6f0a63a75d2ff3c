#include "highlights/find_lights.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/check.h"
#include "core/parallel.h"
#include "highlights/check_lights.h"
#include "highlights/expected_views.h"
#include "highlights/exposure.h"
#include "highlights/lamp_size.h"
#include "highlights/light_groups.h"
#include "highlights/mirror_test.h"
#include "highlights/paint_test.h"
#include "highlights/seed_surface.h"
#include "highlights/view_brightness.h"

namespace glint {
namespace {

constexpr double kMaxViewAngleDeg = 65;  // silhouettes catch the background
constexpr int kPasses = 2;
constexpr double kMinConditioning = 0.01;
// Of a mirror: bright spots a view that move, and the share of them that lights explain.
constexpr double kMirrorSpots = 8, kMirrorExplained = 0.25;
constexpr double kOneSpotRel = 0.01;  // spread of highlights that share one place's error, diagonals

struct Moving {
  size_t candidate;
  double view_cos;  // between the seed's normal and the direction to the camera
  bool may_move;    // no paint either if a light moved with the camera and so shaded paint anew in every view
};

// What goes dark at its place in the other views. `moving_lights`: to try for lights that move with the camera.
std::vector<Moving> NotPaint(const Scene& scene, const ViewBrightness& brightness, const SeedSurface& surface,
                             const GateOptions& gate, const std::vector<Highlight>& candidates,
                             const std::vector<Light>& moving_lights, Progress& progress) {
  std::vector<std::array<bool, 2>> passed(candidates.size(), {false, false});
  std::vector<double> view_cos(candidates.size(), 1);
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
    view_cos[i] = -ray->dot(samples.front().normal);
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
    if (passed[i][0]) moving.push_back({i, view_cos[i], passed[i][1]});
  return moving;
}

// The strongest, and none that is much fainter than they; in the order of the candidates.
std::vector<Moving> Strongest(const std::vector<Highlight>& candidates, const ViewBrightness& brightness,
                              std::vector<Moving> moving, double min_relative_strength, int max_candidates) {
  const auto strength = [&](const Moving& m) {
    const Highlight& h = candidates[m.candidate];
    return h.strength / brightness.Exposure(h.view) / PeakGain(m.view_cos);
  };
  std::stable_sort(moving.begin(), moving.end(),
                   [&](const Moving& a, const Moving& b) { return strength(a) > strength(b); });
  if (moving.empty()) return moving;
  const double least = min_relative_strength * strength(moving[moving.size() / 10]);
  // A saturated one is brighter than its strength says.
  std::erase_if(
      moving, [&](const Moving& m) { return candidates[m.candidate].saturated_fraction <= 0 && strength(m) < least; });
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

std::vector<char> ViewsThatShow(size_t num_views, const std::vector<Highlight>& of_light) {
  std::vector<char> shows(num_views, 0);
  for (const Highlight& h : of_light) shows[h.view] = 1;
  return shows;
}

// A light that does not shine in all groups says where it does; only there it is expected.
void LimitToGroups(const Scene& scene, const LightGroups& groups, size_t k, Light& light, std::vector<char>& expected) {
  if (groups.count == 1) return;
  for (size_t v = 0; v < scene.views.size(); ++v) {
    if (groups.shines[groups.group_of_view[v]][k])
      light.images.push_back(scene.views[v].name);
    else
      expected[v] = 0;
  }
  if (light.images.size() == scene.views.size()) light.images.clear();
}

std::vector<std::string> Names(const Scene& scene) {
  std::vector<std::string> names;
  for (const View& view : scene.views) names.push_back(view.name);
  return names;
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

// No lamp makes highlights that are narrower than the lobe of the gloss, and that is what another lamp, if it is a
// small one, makes: a cluster of smaller ones is paint. `lights`: by falling support.
void LeaveOutNarrow(const std::vector<double>& widths_deg, std::vector<FoundLight>& lights) {
  constexpr double kNarrow = 0.6, kTellingWidthDeg = 3;
  const auto gloss = std::find_if(lights.begin(), lights.end(), [](const FoundLight& f) { return f.determined; });
  if (gloss == lights.end() || gloss->angular_size_deg > 0) return;
  const double lobe_deg = widths_deg[static_cast<size_t>(gloss - lights.begin())];
  if (lobe_deg < kTellingWidthDeg) return;
  for (size_t k = 0; k < lights.size(); ++k) {
    if (!lights[k].determined || widths_deg[k] >= kNarrow * lobe_deg) continue;
    lights[k].determined = false;
    lights[k].why = fmt::format("its highlights are {:.1f} deg wide, narrower than gloss makes them ({:.1f} deg)",
                                widths_deg[k], lobe_deg);
  }
}

std::string MirrorLike(size_t num_views, size_t num_moving, size_t num_votes, const std::vector<FoundLight>& lights) {
  double explained = 0;
  for (const FoundLight& f : lights)
    if (f.determined) explained += f.support / static_cast<double>(std::max<size_t>(num_votes, 1));
  const double spots = static_cast<double>(num_moving) / static_cast<double>(std::max<size_t>(num_views, 1));
  if (spots < kMirrorSpots || explained > kMirrorExplained) return "";
  return fmt::format(
      "the object mirrors its surroundings like chrome: {:.0f} bright spots a photograph move over it, and lights "
      "explain {:.0f} % of them",
      spots, 100 * explained);
}

}  // namespace

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
    if (f.angular_size_deg > 0) report += fmt::format(", {:.0f} deg across", f.angular_size_deg);
    if (!f.determined) report += " is not determined and not used: " + f.why;
  }
  if (groups.size() > 1)
    report += fmt::format("; the light changes between groups of photographs: {}", fmt::join(groups, " | "));
  if (!mirror_like.empty()) report += "; " + mirror_like;
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
  ViewBrightness brightness(images, size_t(gate.image_memory_mb) << 20, progress);
  brightness.Equalise(RelativeExposures(scene, brightness));
  const SeedSurface surface(seed, scene.points, gate.seed_error_rel * diagonal);
  FindLightsSummary told;
  for (const Highlight& h : candidates) told.candidates += h.status == HighlightStatus::kAccepted;

  // A light that moves with the camera is first taken for a flash; what it really is says better how it shades paint.
  std::vector<Light> moving_lights = {{LightType::kPoint, LightFrame::kCamera, Eigen::Vector3d::Zero(), 0}};
  LightFit fit;
  std::vector<LightObservation> observations;
  std::vector<Moving> moving;
  for (int pass = 0; pass < kPasses; ++pass) {
    moving = NotPaint(scene, brightness, surface, gate, candidates, moving_lights, progress);
    told.not_paint = moving.size();
    moving = Strongest(candidates, brightness, std::move(moving), gate.min_relative_strength, options.max_candidates);
    observations = Observe(scene, surface, candidates, moving);
    fit = FitLights(observations, BoundingBox(seed).center(), diagonal, FitOptions(gate, options));
    moving_lights.resize(1);
    for (const FoundLight& f : fit.lights)
      if (f.light.frame == LightFrame::kCamera) moving_lights.push_back(f.light);
    if (moving_lights.size() == 1) break;
  }
  const std::vector<Eigen::Vector3d> normals = SmoothNormals(seed);
  const auto of_light = [&](size_t k) {
    std::vector<Highlight> highlights;
    for (size_t i = 0; i < moving.size(); ++i)
      if (fit.assignment[i] == static_cast<int>(k)) highlights.push_back(candidates[moving[i].candidate]);
    return highlights;
  };
  std::vector<LightShows> shows;
  for (size_t k = 0; k < fit.lights.size(); ++k)
    shows.push_back({ViewsThatShouldShow(scene, surface, seed, normals, fit.lights[k].light, gate.max_incidence_deg),
                     ViewsThatShow(scene.views.size(), of_light(k))});
  const LightGroups groups = GroupViewsByLight(shows, OrderByNumbers(Names(scene)));
  told.groups = DescribeGroups(groups, Names(scene));
  std::vector<double> widths_deg;
  for (size_t k = 0; k < fit.lights.size(); ++k) {
    FoundLight f = fit.lights[k];
    LimitToGroups(scene, groups, k, f.light, shows[k].expected);
    MeasureSize(scene, surface, of_light(k), BoundingBox(seed).center(), f);
    const auto expected = static_cast<int>(std::count(shows[k].expected.begin(), shows[k].expected.end(), 1));
    if (InsideObject(f.light, seed))
      f.why = "it would lie inside the object";
    else if (Spread(observations, fit.assignment, static_cast<int>(k)) < kOneSpotRel * diagonal)
      f.why = "its highlights are all on one spot";
    else
      f.why = WhyNot(f, expected, diagonal, options);
    f.determined = f.why.empty();
    told.lights.push_back(f);
    widths_deg.push_back(MedianWidthDeg(scene, surface, of_light(k), f.light));
  }
  LeaveOutNarrow(widths_deg, told.lights);
  std::stable_partition(told.lights.begin(), told.lights.end(), [](const FoundLight& f) { return f.determined; });
  told.outlier_share = fit.outlier_share;
  told.mirror_like = MirrorLike(scene.views.size(), told.not_paint, observations.size(), told.lights);
  if (summary) *summary = told;
  return told.lights;
}

}  // namespace glint
