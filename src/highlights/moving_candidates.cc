#include "highlights/moving_candidates.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "highlights/mirror_test.h"
#include "highlights/paint_test.h"

namespace glint {
namespace {

constexpr double kMaxViewAngleDeg = 65;  // silhouettes catch the background

struct Judged {
  double view_cos = 1;
  bool stays = false, moves = false, may_move = false;
};

Judged Judge(const Scene& scene, const ViewBrightness& brightness, const SeedSurface& surface, const GateOptions& gate,
             const Highlight& h, const std::vector<Light>& moving_lights) {
  Judged judged;
  const View& view = scene.views[h.view];
  const auto ray = view.RayThrough(h.px);
  if (!ray) return judged;
  const auto samples = surface.Neighbourhood(view.Center(), *ray);
  if (samples.empty() || samples.front().off_center > 0 || samples.front().fine) return judged;
  judged.view_cos = -ray->dot(samples.front().normal);
  if (judged.view_cos < std::cos(kMaxViewAngleDeg * M_PI / 180)) return judged;
  const auto kept = [&](const Light* light) {
    return KeptBrightness(scene, brightness, surface, light, h, samples.front(),
                          {gate.min_half_change_deg, gate.min_other_views});
  };
  const auto still = kept(nullptr);
  judged.stays = still && *still > gate.paint_ratio;
  judged.moves = still && !judged.stays;
  judged.may_move = judged.moves && std::all_of(moving_lights.begin(), moving_lights.end(), [&](const Light& light) {
                      const auto k = kept(&light);
                      return k && *k <= gate.paint_ratio;
                    });
  return judged;
}

}  // namespace

std::vector<Moving> FindMoving(const Scene& scene, const ViewBrightness& brightness, const SeedSurface& surface,
                               const GateOptions& gate, const std::vector<Highlight>& candidates,
                               const std::vector<Light>& moving_lights, size_t& stay_put, Progress& progress) {
  std::vector<Judged> judged(candidates.size());
  progress.Begin("highlights that move", candidates.size());
  ParallelFor(candidates.size(), 16, [&](size_t i) {
    progress.ThrowIfCancelled();
    progress.Advance();
    if (candidates[i].status == HighlightStatus::kAccepted)
      judged[i] = Judge(scene, brightness, surface, gate, candidates[i], moving_lights);
  });
  std::vector<Moving> moving;
  stay_put = 0;
  for (size_t i = 0; i < judged.size(); ++i) {
    if (judged[i].moves) moving.push_back({i, judged[i].view_cos, judged[i].may_move});
    stay_put += judged[i].stays;
  }
  return moving;
}

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

}  // namespace glint
