#include "highlights/judge_lights.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "core/median.h"
#include "core/square.h"

namespace glint {
namespace {

constexpr double kMinConditioning = 0.01;
constexpr double kOneSpotRel = 0.01;    // spread of highlights that share one place's error, diagonals
constexpr double kTellingWidthDeg = 3;  // of sharper gloss the seed's facets decide how wide it looks
constexpr size_t kFewestWidths = 5;
constexpr double kAboutSpread = 0.75;  // of the spread, of which the seed's error is a half (SeedSurface)
constexpr double kSigmaOfMad = 1.4826;
constexpr double kLeastLogSigma = 0.1;
// Bright spots a view that move, and the share of them that lights explain, of what is no gloss under a few lights.
constexpr double kManySpots = 8, kLittleExplained = 0.25;

// Empty: it is determined, as far as how often it shows does not matter.
std::string WhyNot(const FoundLight& f, const LightEvidence& e, double diagonal, const FindLightsOptions& options) {
  const bool distant = f.light.type == LightType::kDistant;
  const double max_sigma = distant ? options.max_sigma_deg : options.max_sigma_deg * M_PI / 180 * 5 * diagonal;
  if (e.spread_world < kOneSpotRel * diagonal) return "its highlights are all on one spot";
  if (f.support < options.min_support) return fmt::format("only {:.1f} highlights point to it", f.support);
  if (f.light.sigma > max_sigma)
    return distant
               ? fmt::format("its direction is uncertain by {:.1f} deg", f.light.sigma)
               : fmt::format("its position is uncertain by {:.2g} diagonals of the object", f.light.sigma / diagonal);
  if (distant && f.conditioning < kMinConditioning) return "its highlights all have about the same normal";
  if (f.normal_sigma_deg > options.max_normal_sigma_deg)
    return fmt::format("the surface's normals agree with it to {:.1f} deg only", f.normal_sigma_deg);
  return "";
}

// How many marks might agree with a light as closely by chance: as densely as in a crowd that agrees with its light but
// broadly and so is none, and twice that, for lights are where marks happen to be dense.
double ChanceSupport(const FoundLight& f, const std::vector<FoundLight>& lights, const FindLightsOptions& options) {
  double most = 0;
  for (const FoundLight& crowd : lights)
    if (crowd.normal_sigma_deg > options.max_normal_sigma_deg)
      most = std::max(most, 2 * crowd.support * Square(f.normal_sigma_deg / crowd.normal_sigma_deg));
  return most;
}

double Completeness(const FoundLight& f, const LightEvidence& e) {
  return e.expected_views > 0 ? std::min(1.0, f.support / e.expected_views) : 1;
}

// Highlights that no better supported light that is determined explains as well as light k's normals are known.
int NeededFor(const std::vector<FoundLight>& lights, const LightEvidence& evidence, size_t k) {
  return static_cast<int>(std::count_if(evidence.off_deg.begin(), evidence.off_deg.end(), [&](const auto& off_deg) {
    for (size_t j = 0; j < k && j < off_deg.size(); ++j)
      if (lights[j].determined && off_deg[j] < 2 * lights[j].normal_sigma_deg) return false;
    return true;
  }));
}

void LeaveOutNeedless(const std::vector<LightEvidence>& evidence, const FindLightsOptions& options,
                      std::vector<FoundLight>& lights) {
  for (size_t k = 0; k < lights.size(); ++k) {
    FoundLight& f = lights[k];
    if (!f.determined || evidence[k].half_sigma_deg < f.normal_sigma_deg || evidence[k].off_deg.empty()) continue;
    const int needed = NeededFor(lights, evidence[k], k);
    if (needed >= options.min_support) continue;
    f.determined = false;
    f.why = fmt::format(
        "it is no surer than the surface's normals, and all but {} of its highlights may be another light's", needed);
  }
}

struct LogWidths {
  double median = 0, sigma = 0;
};

LogWidths LogWidthsOf(const std::vector<double>& widths_deg) {
  std::vector<double> logs, deviations;
  for (double width : widths_deg) logs.push_back(std::log(width));
  const double median = Median(logs);
  for (double log : logs) deviations.push_back(std::abs(log - median));
  return {median, std::max(kLeastLogSigma, kSigmaOfMad * Median(deviations))};
}

void LeaveOutNarrow(const std::vector<LightEvidence>& evidence, std::vector<FoundLight>& lights) {
  const auto gloss = std::find_if(lights.begin(), lights.end(), [](const FoundLight& f) { return f.determined; });
  if (gloss == lights.end() || gloss->angular_size_deg > 0) return;
  const std::vector<double>& widths = evidence[static_cast<size_t>(gloss - lights.begin())].widths_deg;
  for (size_t k = 0; k < lights.size(); ++k) {
    if (!lights[k].determined || !NarrowerThanGloss(widths, evidence[k].widths_deg)) continue;
    lights[k].determined = false;
    lights[k].why = fmt::format("its highlights are {:.1f} deg wide, narrower than gloss makes them ({:.1f} deg)",
                                Median(evidence[k].widths_deg), Median(widths));
  }
}

}  // namespace

bool NarrowerThanGloss(const std::vector<double>& gloss_deg, const std::vector<double>& cluster_deg) {
  if (std::min(gloss_deg.size(), cluster_deg.size()) < kFewestWidths || Median(gloss_deg) < kTellingWidthDeg)
    return false;
  const LogWidths gloss = LogWidthsOf(gloss_deg), cluster = LogWidthsOf(cluster_deg);
  const double of_median = cluster.sigma * std::sqrt(M_PI / 2 / static_cast<double>(cluster_deg.size()));
  return gloss.median - cluster.median > 2 * std::hypot(gloss.sigma, of_median);
}

void MeasureOff(const Scene& scene, const SeedSurface& surface, const std::vector<Highlight>& highlights,
                const std::vector<FoundLight>& lights, LightEvidence& evidence) {
  evidence.off_deg.clear();
  for (const Highlight& h : highlights) {
    const View& view = scene.views[h.view];
    const auto ray = view.RayThrough(h.px);
    if (!ray) continue;
    std::vector<double>& off_deg = evidence.off_deg.emplace_back(lights.size(), 180.0);
    for (const SurfaceSample& s : surface.Neighbourhood(view.Center(), *ray)) {
      if (s.off_center > kAboutSpread) continue;
      for (size_t j = 0; j < lights.size(); ++j) {
        const Eigen::Vector3d half = HalfVector(lights[j].light, view.cam_from_world, s.position);
        off_deg[j] = std::min(off_deg[j], std::atan2(half.cross(s.normal).norm(), half.dot(s.normal)) * 180 / M_PI);
      }
    }
  }
}

void JudgeLights(const std::vector<LightEvidence>& evidence, double diagonal, const FindLightsOptions& options,
                 std::vector<FoundLight>& lights) {
  double most_complete = 0;
  for (size_t k = 0; k < lights.size(); ++k) {
    lights[k].why = WhyNot(lights[k], evidence[k], diagonal, options);
    if (lights[k].why.empty() && lights[k].support < ChanceSupport(lights[k], lights, options))
      lights[k].why = fmt::format("marks on the object make {:.0f} such highlights by chance", lights[k].support);
    const double completeness = Completeness(lights[k], evidence[k]);
    if (lights[k].why.empty() && completeness >= options.min_completeness)
      most_complete = std::max(most_complete, completeness);
  }
  const double least = options.min_completeness * (most_complete > 0 ? most_complete : 1);
  for (size_t k = 0; k < lights.size(); ++k) {
    FoundLight& f = lights[k];
    if (f.why.empty() && Completeness(f, evidence[k]) < least)
      f.why = fmt::format("only {:.0f} highlights point to it, and {} views should show it", f.support,
                          evidence[k].expected_views);
    f.determined = f.why.empty();
  }
  LeaveOutNarrow(evidence, lights);
  LeaveOutNeedless(evidence, options, lights);
}

std::string NotHighlights(const BrightSpots& spots, const std::vector<FoundLight>& lights) {
  double explained = 0;
  for (const FoundLight& f : lights)
    if (f.determined) explained += f.support / static_cast<double>(std::max<size_t>(spots.voting, 1));
  const double per_view = 1 / static_cast<double>(std::max<size_t>(spots.views, 1));
  const double moving = per_view * static_cast<double>(spots.moving);
  if (moving < kManySpots || explained > kLittleExplained) return "";
  if (spots.moving >= spots.stay_put)
    return fmt::format(
        "the object mirrors its surroundings like chrome: {:.0f} bright spots a photograph move over it, and lights "
        "explain {:.0f} % of them",
        moving, 100 * explained);
  // Of marks many seem to move where the sparse surface is off; a light among them is told by its highlights.
  if (explained > 0) return "";
  return fmt::format(
      "no light makes the bright spots on the object: of {:.0f} a photograph {:.0f} % stay at their place, as print, "
      "texture or relief does, and the rest do not agree on any light",
      moving + per_view * static_cast<double>(spots.stay_put),
      100.0 * static_cast<double>(spots.stay_put) / static_cast<double>(spots.moving + spots.stay_put));
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
    if (f.angular_size_deg > 0) report += fmt::format(", {:.0f} deg across", f.angular_size_deg);
    if (!f.determined) report += " is not determined and not used: " + f.why;
  }
  if (groups.size() > 1)
    report += fmt::format("; the light changes between groups of photographs: {}", fmt::join(groups, " | "));
  if (!mirror_like.empty()) report += "; " + mirror_like;
  if (used > 0) report += fmt::format("; {:.0f} % explained by no light", 100 * outlier_share);
  return report;
}

}  // namespace glint
