#include "highlights/gate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "core/check.h"
#include "core/median.h"
#include "core/parallel.h"
#include "highlights/consensus.h"
#include "highlights/exposure.h"
#include "highlights/mirror_test.h"
#include "highlights/paint_test.h"
#include "highlights/seed_surface.h"
#include "highlights/view_brightness.h"

namespace glint {
namespace {

constexpr double kAmbiguousDeg = 4;  // a second light that explains it this nearly as well

double AngleDeg(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) * 180 / M_PI;
}

struct Explanation {
  int light = -1;
  double error_deg = std::numeric_limits<double>::infinity();  // half vector against the nearest of the normals
  double incidence_deg = 0;
  bool ambiguous = false;
  SurfaceSample at;      // the sample that agrees best
  SurfaceSample middle;  // where the ray meets the seed, or nearest to it
};

// The light that is mirrored best by any of the samples; those in the seed's shadow do not count.
Explanation Explain(const View& view, const SeedSurface& surface, const std::vector<Light>& lights,
                    const std::vector<SurfaceSample>& samples) {
  Explanation best;
  double second_deg = std::numeric_limits<double>::infinity();
  for (size_t l = 0; l < lights.size(); ++l) {
    if (!ShinesIn(lights[l], view.name)) continue;
    double error_deg = std::numeric_limits<double>::infinity();
    const SurfaceSample* at = nullptr;
    for (const SurfaceSample& s : samples) {
      const double e = AngleDeg(HalfVector(lights[l], view.cam_from_world, s.position), s.normal);
      if (e < error_deg) error_deg = e, at = &s;
    }
    if (!at) continue;
    const Eigen::Vector3d to_light = DirectionToLight(lights[l], view.cam_from_world, at->position);
    const Eigen::Vector3d lamp = lights[l].type == LightType::kPoint && lights[l].frame == LightFrame::kWorld
                                     ? lights[l].vector
                                     : Eigen::Vector3d(at->position + 2 * surface.diagonal() * to_light);
    if (lights[l].type == LightType::kDistant && surface.Occluded(*at, lamp)) continue;
    if (error_deg < best.error_deg) {
      second_deg = best.error_deg;
      best.light = static_cast<int>(l);
      best.error_deg = error_deg;
      best.incidence_deg =
          AngleDeg(HalfVector(lights[l], view.cam_from_world, at->position), view.Center() - at->position);
      best.at = *at;
    } else {
      second_deg = std::min(second_deg, error_deg);
    }
  }
  best.ambiguous = best.light >= 0 && second_deg - best.error_deg < kAmbiguousDeg;
  return best;
}

// KeptBrightness() where the ray meets the seed and at the depth of the sample that explains the highlight: at a
// silhouette the ray may have missed the surface that it belongs to.
std::optional<double> MostKept(const Scene& scene, const ViewBrightness& brightness, const SeedSurface& surface,
                               const Light& light, const GateOptions& options, const Highlight& highlight,
                               const SurfaceSample& hit, const SurfaceSample& explaining) {
  const PaintTestOptions paint = {options.min_half_change_deg, options.min_other_views};
  const auto at_hit = KeptBrightness(scene, brightness, surface, &light, highlight, hit, paint);
  const View& view = scene.views[highlight.view];
  SurfaceSample moved = explaining;
  moved.position = view.Center() + *view.RayThrough(highlight.px) * (explaining.position - view.Center()).norm();
  if ((moved.position - hit.position).norm() < hit.error_world) return at_hit;
  const auto at_explaining = KeptBrightness(scene, brightness, surface, &light, highlight, moved, paint);
  if (!at_hit || !at_explaining) return at_hit ? at_hit : at_explaining;
  return std::max(*at_hit, *at_explaining);
}

struct Verdict {
  HighlightStatus status = HighlightStatus::kAccepted;
  Explanation explanation;
};

Verdict Judge(const Scene& scene, const ViewBrightness& brightness, const SeedSurface& surface,
              const std::vector<Light>& lights, const GateOptions& options, const Highlight& highlight) {
  Verdict verdict;
  const View& view = scene.views[highlight.view];
  const auto ray = view.RayThrough(highlight.px);
  std::vector<SurfaceSample> samples;
  if (ray) samples = surface.Neighbourhood(view.Center(), *ray);
  if (samples.empty()) {
    verdict.status = HighlightStatus::kOffSurface;
    return verdict;
  }
  verdict.explanation = Explain(view, surface, lights, samples);
  verdict.explanation.middle = samples.front();
  const Explanation& e = verdict.explanation;
  if (e.light < 0 || e.error_deg > options.max_normal_error_deg) {
    verdict.status = HighlightStatus::kWrongNormal;
    return verdict;
  }
  if (e.incidence_deg > options.max_incidence_deg) {
    verdict.status = HighlightStatus::kGrazing;
    return verdict;
  }
  const auto kept = MostKept(scene, brightness, surface, lights[e.light], options, highlight, samples.front(), e.at);
  if (!kept)
    verdict.status = HighlightStatus::kTooFewViews;
  else if (*kept > options.paint_ratio)
    verdict.status = HighlightStatus::kStaysPut;
  return verdict;
}

// See consensus.h.
void RejectUnlike(const Scene& scene, const SeedSurface& surface, const std::vector<Light>& lights,
                  const std::vector<Highlight>& highlights, const std::vector<size_t>& judged,
                  std::vector<Verdict>& verdicts) {
  std::vector<size_t> accepted;
  std::vector<SeenOnSeed> seen;
  for (size_t k = 0; k < judged.size(); ++k) {
    if (verdicts[k].status != HighlightStatus::kAccepted) continue;
    const Explanation& e = verdicts[k].explanation;
    const Highlight& h = highlights[judged[k]];
    const View& view = scene.views[h.view];
    const Eigen::Vector3d half = HalfVector(lights[e.light], view.cam_from_world, e.middle.position);
    accepted.push_back(k);
    seen.push_back(
        {e.light, AngleDeg(half, e.middle.normal), MirrorTest(view, surface, lights[e.light], h, e.middle).WidthDeg()});
  }
  const std::vector<Unlike> unlike = FindUnlike(seen, static_cast<int>(lights.size()));
  for (size_t i = 0; i < accepted.size(); ++i) {
    if (unlike[i] == Unlike::kNormal) verdicts[accepted[i]].status = HighlightStatus::kWrongNormal;
    if (unlike[i] == Unlike::kWidth) verdicts[accepted[i]].status = HighlightStatus::kWrongSize;
  }
}

// See GateHighlights(): what is much fainter than a light's strong highlights.
void RejectFaint(const std::vector<Highlight>& highlights, const ViewBrightness& brightness,
                 const std::vector<size_t>& judged, size_t num_lights, double min_relative_strength,
                 std::vector<Verdict>& verdicts) {
  const auto strength = [&](size_t k) {
    const Highlight& h = highlights[judged[k]];
    return h.strength / brightness.Exposure(h.view) /
           PeakGain(std::cos(verdicts[k].explanation.incidence_deg * M_PI / 180));
  };
  std::vector<std::vector<double>> strengths(num_lights);
  for (size_t k = 0; k < judged.size(); ++k)
    if (verdicts[k].status == HighlightStatus::kAccepted)
      strengths[verdicts[k].explanation.light].push_back(strength(k));
  std::vector<double> least(num_lights, 0);
  for (size_t l = 0; l < num_lights; ++l) {
    if (strengths[l].empty()) continue;
    const size_t strong = strengths[l].size() * 9 / 10;
    std::nth_element(strengths[l].begin(), strengths[l].begin() + strong, strengths[l].end());
    least[l] = min_relative_strength * strengths[l][strong];
  }
  for (size_t k = 0; k < judged.size(); ++k) {
    const bool saturated = highlights[judged[k]].saturated_fraction > 0;  // brighter than its strength says
    if (verdicts[k].status == HighlightStatus::kAccepted && !saturated &&
        strength(k) < least[verdicts[k].explanation.light])
      verdicts[k].status = HighlightStatus::kWeak;
  }
}

// Whether two finds are one blob at two scales: one's peak lies within the other.
bool LieWithin(const Highlight& a, const Highlight& b) {
  // Standard deviations of the smaller blob (its half height), and of the larger one.
  constexpr double kSmaller = 2, kLarger = 1;
  const bool first = a.area_px < b.area_px;
  const Eigen::Vector2d d = a.px - b.px;
  const auto within = [&](const Eigen::Matrix2d& moments, double limit) {
    return d.dot(moments.inverse() * d) < limit * limit;
  };
  return within(first ? a.moments_px : b.moments_px, kSmaller) || within(first ? b.moments_px : a.moments_px, kLarger);
}

// One lamp has one mirror point on a patch: of accepted ones that lie within each other, the one known best is kept. A
// detector of blobs finds a lobe again at a coarser scale, where a body of paint that rises towards the lamp, too,
// makes it look the stronger.
void RejectRepeated(const std::vector<Highlight>& highlights, const std::vector<size_t>& judged,
                    std::vector<Verdict>& verdicts) {
  const auto of = [&](size_t k) -> const Highlight& { return highlights[judged[k]]; };
  std::vector<size_t> best_first;
  for (size_t k = 0; k < judged.size(); ++k)
    if (verdicts[k].status == HighlightStatus::kAccepted) best_first.push_back(k);
  std::stable_sort(best_first.begin(), best_first.end(),
                   [&](size_t a, size_t b) { return of(a).covariance_px.trace() < of(b).covariance_px.trace(); });
  std::map<std::pair<uint32_t, int>, std::vector<size_t>> kept;  // by view and light
  for (const size_t k : best_first) {
    std::vector<size_t>& others = kept[{of(k).view, verdicts[k].explanation.light}];
    if (std::any_of(others.begin(), others.end(), [&](size_t other) { return LieWithin(of(k), of(other)); }))
      verdicts[k].status = HighlightStatus::kRepeated;
    else
      others.push_back(k);
  }
}

// What is seen of a broad lobe peaks beside the point that mirrors the light.
void MoveToMirrorPoint(const View& view, const SeedSurface& surface, const Light& light, const SurfaceSample& at,
                       Highlight& highlight) {
  constexpr double kUnsure = 0.3;  // of the shift: the surface's curvature is the seed's
  // What is cut off at white looks broader than its lobe is.
  if (highlight.saturated_fraction > 0) return;
  const Eigen::Vector2d shift = MirrorTest(view, surface, light, highlight, at).PeakShift();
  highlight.px -= shift;
  highlight.covariance_px += kUnsure * kUnsure * shift * shift.transpose();
}

GateSummary Summarise(const std::vector<Highlight>& highlights, const std::vector<Verdict>& verdicts,
                      const std::vector<size_t>& judged, size_t num_lights) {
  GateSummary summary;
  summary.candidates = highlights.size();
  summary.accepted_by_light.assign(num_lights, 0);
  std::vector<std::vector<double>> errors(num_lights);
  size_t ambiguous = 0;
  for (const Highlight& h : highlights) ++summary.by_status[static_cast<size_t>(h.status)];
  for (size_t k = 0; k < judged.size(); ++k) {
    if (verdicts[k].status != HighlightStatus::kAccepted) continue;
    const Explanation& e = verdicts[k].explanation;
    ++summary.accepted;
    ++summary.accepted_by_light[e.light];
    errors[e.light].push_back(e.error_deg);
    ambiguous += e.ambiguous;
  }
  for (auto& e : errors) summary.median_normal_error_deg.push_back(Median(std::move(e)));
  summary.ambiguous_fraction = summary.accepted > 0 ? double(ambiguous) / summary.accepted : 0;
  return summary;
}

}  // namespace

std::string GateSummary::BriefReport() const {
  std::string report = fmt::format("{} of {} highlight candidates accepted", accepted, candidates);
  for (int s = 1; s < kNumHighlightStatuses; ++s)
    if (by_status[s] > 0) report += fmt::format(", {} {}", by_status[s], StatusName(static_cast<HighlightStatus>(s)));
  for (size_t l = 0; l < accepted_by_light.size(); ++l)
    report += fmt::format("; light {}: {} ({:.1f} deg from the seed's normals)", l, accepted_by_light[l],
                          median_normal_error_deg[l]);
  return report;
}

void GateHighlights(const Scene& scene, const ImageSource& images, const TriangleMesh& seed,
                    const std::vector<Light>& lights, const GateOptions& options, std::vector<Highlight>& highlights,
                    GateSummary* summary, Progress& progress) {
  GLINT_CHECK_EQ(images.size(), scene.views.size());
  GLINT_CHECK(!seed.empty());
  ViewBrightness brightness(images, size_t(options.image_memory_mb) << 20, progress);
  brightness.Equalise(RelativeExposures(scene, brightness));
  const SeedSurface surface(seed, scene.points, options.seed_error_rel * Diagonal(seed));

  std::vector<size_t> judged;
  for (size_t i = 0; i < highlights.size(); ++i) {
    GLINT_CHECK_LT(highlights[i].view, scene.views.size());
    if (highlights[i].status == HighlightStatus::kAccepted) judged.push_back(i);
  }
  std::vector<Verdict> verdicts(judged.size());
  progress.Begin("highlights against the other views", judged.size());
  ParallelFor(judged.size(), 16, [&](size_t k) {
    progress.ThrowIfCancelled();
    verdicts[k] = Judge(scene, brightness, surface, lights, options, highlights[judged[k]]);
    progress.Advance();
  });
  RejectUnlike(scene, surface, lights, highlights, judged, verdicts);
  RejectFaint(highlights, brightness, judged, lights.size(), options.min_relative_strength, verdicts);
  RejectRepeated(highlights, judged, verdicts);
  for (size_t k = 0; k < judged.size(); ++k) {
    Highlight& h = highlights[judged[k]];
    h.status = verdicts[k].status;
    h.light = verdicts[k].explanation.light;
    if (h.status == HighlightStatus::kAccepted)
      MoveToMirrorPoint(scene.views[h.view], surface, lights[h.light], verdicts[k].explanation.at, h);
  }
  if (summary) *summary = Summarise(highlights, verdicts, judged, lights.size());
}

}  // namespace glint
