#include "highlights/exposure.h"

#include <algorithm>
#include <cmath>

#include "core/median.h"

namespace glint {
namespace {

constexpr size_t kFewestPoints = 12;
constexpr int kRounds = 10;
constexpr double kDarkest = 0.0015, kBrightest = 0.85;  // beyond them a pixel says little of its exposure
constexpr double kSame = 0.12;                          // of the logarithm: shading does that much from view to view
constexpr double kSigmas = 4;

struct Sample {
  uint32_t view;
  double log_value;
};

std::vector<std::vector<Sample>> SamplesByPoint(const Scene& scene, const ViewBrightness& brightness) {
  std::vector<std::vector<Sample>> by_point;
  for (const ScenePoint& point : scene.points) {
    std::vector<Sample> samples;
    for (const Observation& o : point.observations) {
      const auto value = brightness.MeanNear(o.view, o.px.cast<double>(), 1.5);
      if (value && *value > kDarkest && *value < kBrightest) samples.push_back({o.view, std::log(*value)});
    }
    if (samples.size() >= 2) by_point.push_back(std::move(samples));
  }
  return by_point;
}

}  // namespace

std::vector<double> RelativeExposures(const Scene& scene, const ViewBrightness& brightness) {
  const size_t num_views = scene.views.size();
  const auto by_point = SamplesByPoint(scene, brightness);
  std::vector<double> gain(num_views, 0), uncertainty(num_views, 0);
  std::vector<std::vector<double>> differences(num_views);
  // Medians by turns: of a point over its views, of a view over its points.
  for (int round = 0; round < kRounds; ++round) {
    for (auto& d : differences) d.clear();
    for (const auto& samples : by_point) {
      std::vector<double> values;
      for (const Sample& s : samples) values.push_back(s.log_value - gain[s.view]);
      const double albedo = Median(values);
      for (const Sample& s : samples) differences[s.view].push_back(s.log_value - albedo);
    }
    std::vector<double> known;
    for (size_t v = 0; v < num_views; ++v) {
      if (differences[v].size() < kFewestPoints) continue;
      gain[v] = Median(differences[v]);
      std::vector<double> deviations;
      for (double d : differences[v]) deviations.push_back(std::abs(d - gain[v]));
      uncertainty[v] = 1.4826 * Median(deviations) / std::sqrt(static_cast<double>(deviations.size()));
      known.push_back(gain[v]);
    }
    const double middle = Median(known);
    for (size_t v = 0; v < num_views; ++v)
      if (differences[v].size() >= kFewestPoints) gain[v] -= middle;
  }
  std::vector<double> exposures(num_views, 1);
  for (size_t v = 0; v < num_views; ++v)
    if (std::abs(gain[v]) > std::max(kSame, kSigmas * uncertainty[v])) exposures[v] = std::exp(gain[v]);
  return exposures;
}

}  // namespace glint
