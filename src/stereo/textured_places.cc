#include "stereo/textured_places.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "core/median.h"
#include "core/parallel.h"

namespace glint {
namespace {

constexpr double kRadians = M_PI / 180;
constexpr int kHalf = 3;  // seven by seven samples
constexpr size_t kWide = 2 * kHalf + 1, kNumSamples = kWide * kWide, kNumValues = 3 * kNumSamples;
constexpr size_t kMaxOthers = 6;
constexpr size_t kFewestAgreeing = 3;
// Between the lines of sight: less says little about the depth, more shows two different pictures.
const double kMaxBaselineCosine = std::cos(4 * kRadians), kMinBaselineCosine = std::cos(40 * kRadians);
constexpr double kStepPx = 0.5;          // of the parallax between neighbouring offsets
constexpr int kMaxSteps = 16;            // either way
constexpr float kLeastContrast = 0.02F;  // five levels of 255, as the eye counts them
constexpr double kLeastPeak = 0.85;      // of the correlation
constexpr double kLeastDrop = 0.15;      // from the peak to the rest, two steps away and more
constexpr double kAgreeSteps = 1.5;
constexpr double kLeastSigmaSteps = 0.2;  // what blur and bilinear samples leave

using Values = std::array<float, kNumValues>;

struct Plane {
  Eigen::Vector3d center, normal, across_u, across_v;  // the last two as long as a sample is wide
};

Plane PlaneOf(const SurfacePatch& patch, double sample_world) {
  const Eigen::Vector3d u = patch.normal.unitOrthogonal();
  return {patch.position, patch.normal, sample_world * u, sample_world * patch.normal.cross(u)};
}

// The picture that a view shows on the plane moved by `offset`, each channel with mean zero, all together of length
// one; `contrast`: the deviation before. Nothing where a sample is not seen.
std::optional<Values> Picture(const View& view, uint32_t index, const SightColors& colors, const Plane& plane,
                              double offset, float* contrast = nullptr) {
  Values values;
  size_t k = 0;
  Eigen::Array3f mean = Eigen::Array3f::Zero();
  for (int i = -kHalf; i <= kHalf; ++i)
    for (int j = -kHalf; j <= kHalf; ++j) {
      const auto px = view.Project(plane.center + offset * plane.normal + i * plane.across_u + j * plane.across_v);
      const auto color = px ? colors.At(index, *px) : std::nullopt;
      if (!color) return std::nullopt;
      mean += *color;
      for (int c = 0; c < 3; ++c) values[k++] = (*color)[c];
    }
  mean /= static_cast<float>(kNumSamples);
  float squared = 0;
  for (size_t i = 0; i < kNumValues; ++i) {
    values[i] -= mean[static_cast<Eigen::Index>(i % 3)];
    squared += values[i] * values[i];
  }
  if (contrast) *contrast = std::sqrt(squared / static_cast<float>(kNumSamples));
  if (!(squared > 0)) return std::nullopt;
  for (float& v : values) v /= std::sqrt(squared);
  return values;
}

// Where along the offsets (in steps) one view agrees best; nothing if that is at an end, weak or not distinct.
std::optional<double> Peak(const std::vector<double>& correlation) {
  const auto best = std::max_element(correlation.begin(), correlation.end()) - correlation.begin();
  const auto last = static_cast<std::ptrdiff_t>(correlation.size()) - 1;
  if (best == 0 || best == last || correlation[best] < kLeastPeak) return std::nullopt;
  double before = 1, after = 1;  // the least on either side
  for (std::ptrdiff_t i = 0; i <= last; ++i) {
    if (i < best) before = std::min(before, correlation[i]);
    if (i > best) after = std::min(after, correlation[i]);
    if (std::abs(i - best) > 3 && correlation[i] > correlation[best] - kLeastDrop) return std::nullopt;
  }
  if (std::max(before, after) > correlation[best] - kLeastDrop) return std::nullopt;
  const double l = correlation[best - 1], m = correlation[best], r = correlation[best + 1];
  const double bend = l - 2 * m + r;
  return static_cast<double>(best) + (bend < 0 ? 0.5 * (l - r) / bend : 0);
}

class Searcher {
 public:
  Searcher(const Scene& scene, const SightColors& colors, const std::vector<Light>& lights, double reach_world)
      : scene_(scene), colors_(colors), lights_(lights), reach_(reach_world) {
    for (const View& view : scene.views) centers_.push_back(view.Center());
  }

  std::optional<TexturedPlace> Search(const SurfacePatch& patch) const {
    const std::vector<uint32_t> views = ViewsOf(patch);
    if (views.size() < kFewestAgreeing + 1) return std::nullopt;
    const View& reference = scene_.views[views[0]];
    const double depth = (reference.cam_from_world * patch.position).z();
    const double sample = depth * colors_.PixelSize(views[0]) / MeanFocalLength(reference.camera);
    if (!(sample > 0)) return std::nullopt;
    const Plane plane = PlaneOf(patch, sample);
    float contrast = 0;
    if (!Picture(reference, views[0], colors_, plane, 0, &contrast) || contrast < kLeastContrast) return std::nullopt;
    const double step = kStepPx * sample / WidestParallax(patch, views);
    const int steps = static_cast<int>(std::min<double>(kMaxSteps, std::ceil(reach_ / step)));
    if (steps < 4) return std::nullopt;
    return Agree(plane, step, steps, Peaks(views, plane, step, steps));
  }

 private:
  // The reference, and others that see the patch from elsewhere.
  std::vector<uint32_t> ViewsOf(const SurfacePatch& patch) const {
    std::vector<uint32_t> views;
    for (const PatchView& seen : patch.views) {
      if (!colors_.Has(seen.view) || Mirrors(scene_.views[seen.view], lights_, patch)) continue;
      const double cosine = views.empty() ? 0 : BaselineCosine(patch, views[0], seen.view);
      if (views.empty() || (cosine < kMaxBaselineCosine && cosine > kMinBaselineCosine)) views.push_back(seen.view);
      if (views.size() > kMaxOthers) break;
    }
    return views;
  }

  double BaselineCosine(const SurfacePatch& patch, uint32_t a, uint32_t b) const {
    return (centers_[a] - patch.position).normalized().dot((centers_[b] - patch.position).normalized());
  }

  // Of a motion along the normal, between the reference and the view that sees the most of it; in units of the motion.
  double WidestParallax(const SurfacePatch& patch, const std::vector<uint32_t>& views) const {
    double widest = 1e-3;
    const Eigen::Vector3d from = (centers_[views[0]] - patch.position).normalized();
    for (size_t i = 1; i < views.size(); ++i) {
      const Eigen::Vector3d to = (centers_[views[i]] - patch.position).normalized();
      const Eigen::Vector3d a = from - from.dot(patch.normal) * patch.normal,
                            b = to - to.dot(patch.normal) * patch.normal;
      widest = std::max(widest, (a / from.dot(patch.normal) - b / to.dot(patch.normal)).norm());
    }
    return widest;
  }

  std::vector<double> Peaks(const std::vector<uint32_t>& views, const Plane& plane, double step, int steps) const {
    std::vector<std::vector<double>> correlation(views.size() - 1);
    for (int s = -steps; s <= steps; ++s) {
      const auto own = Picture(scene_.views[views[0]], views[0], colors_, plane, s * step);
      for (size_t i = 1; i < views.size(); ++i) {
        const auto other = own ? Picture(scene_.views[views[i]], views[i], colors_, plane, s * step) : std::nullopt;
        double sum = other ? 0 : -1;
        for (size_t k = 0; other && k < kNumValues; ++k) sum += (*own)[k] * (*other)[k];
        correlation[i - 1].push_back(sum);
      }
    }
    std::vector<double> peaks;
    for (const std::vector<double>& c : correlation)
      if (const auto peak = Peak(c)) peaks.push_back(*peak - steps);
    return peaks;
  }

  static std::optional<TexturedPlace> Agree(const Plane& plane, double step, int steps, std::vector<double> peaks) {
    if (peaks.size() < kFewestAgreeing) return std::nullopt;
    const double middle = Median(peaks);
    std::erase_if(peaks, [&](double p) { return std::abs(p - middle) > kAgreeSteps; });
    if (peaks.size() < kFewestAgreeing) return std::nullopt;
    double sum = 0, squared = 0;
    for (const double p : peaks) sum += p;
    const double n = static_cast<double>(peaks.size()), mean = sum / n;
    for (const double p : peaks) squared += (p - mean) * (p - mean);
    const double sigma = std::sqrt(squared / (n - 1) / n) + kLeastSigmaSteps;
    if (std::abs(mean) > steps - 1) return std::nullopt;
    return TexturedPlace{plane.center + mean * step * plane.normal, plane.normal, sigma * step};
  }

  const Scene& scene_;
  const SightColors& colors_;
  const std::vector<Light>& lights_;
  double reach_;
  std::vector<Eigen::Vector3d> centers_;
};

}  // namespace

std::vector<TexturedPlace> FindTexturedPlaces(const Scene& scene, const SightColors& colors,
                                              const std::vector<SurfacePatch>& patches,
                                              const std::vector<Light>& lights, double reach_world) {
  const Searcher searcher(scene, colors, lights, reach_world);
  std::vector<std::optional<TexturedPlace>> found(patches.size());
  ParallelFor(patches.size(), 16, [&](size_t i) { found[i] = searcher.Search(patches[i]); });
  std::vector<TexturedPlace> places;
  for (const auto& place : found)
    if (place) places.push_back(*place);
  return places;
}

}  // namespace glint
