#include "silhouette/agreement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

namespace glint::internal {
namespace {

constexpr int kSteps = 40;  // through the ball
constexpr int kFinerSteps = 8;
constexpr int kMaxContradictions = 8;

// By how much each mask (but `skip`) that knows of x has it outside, world units.
template <class Visit>
void ForWitnesses(const Scene& scene, const std::vector<ViewMask>& masks, const Eigen::Vector3d& x, int skip,
                  const Visit& visit) {
  for (int m = 0; m < static_cast<int>(masks.size()); ++m) {
    if (m == skip) continue;
    const View& view = scene.views[masks[m].view];
    const auto px = view.Project(x);
    if (!px) continue;
    const auto distance_px = masks[m].DistanceAt(view, *px);
    if (distance_px) visit(*distance_px * (x - masks[m].eye).norm() / masks[m].focal_px);
  }
}

}  // namespace

std::optional<double> OutsideBy(const Scene& scene, const MaskSet& set, const Eigen::Vector3d& x, int skip) {
  std::array<double, kMaxContradictions> worst;
  worst.fill(-kFar);
  const int count = std::clamp(set.contradictions, 1, kMaxContradictions);
  size_t witnesses = 0;
  ForWitnesses(scene, set.masks, x, skip, [&](double d) {
    ++witnesses;
    for (int k = 0; k < count; ++k)
      if (d > worst[k]) std::swap(d, worst[k]);
  });
  if (witnesses < kMinWitnesses) return std::nullopt;
  return worst[count - 1];
}

std::optional<double> OutsideByMost(const Scene& scene, const std::vector<ViewMask>& masks, const Eigen::Vector3d& x,
                                    double wrong_share) {
  std::vector<double> distances;
  ForWitnesses(scene, masks, x, -1, [&](double d) { distances.push_back(d); });
  if (distances.size() < kMinWitnesses || 2 * distances.size() < masks.size()) return std::nullopt;
  const auto wrong = static_cast<size_t>(wrong_share * static_cast<double>(distances.size()));
  std::nth_element(distances.begin(), distances.begin() + wrong, distances.end(), std::greater<>());
  return distances[wrong];
}

std::optional<double> FindContact(const Scene& scene, const MaskSet& set, int own, const Reach& reach, double slack,
                                  OutlineSample& sample) {
  const Eigen::Vector3d& eye = set.masks[own].eye;
  const double middle = (reach.center - eye).dot(sample.ray);
  const double off = (eye + middle * sample.ray - reach.center).norm();
  if (off >= reach.radius) return std::nullopt;
  const double half = std::sqrt(reach.radius * reach.radius - off * off);
  const double begin = std::max(middle - half, 1e-3 * reach.radius), end = middle + half;
  if (begin >= end) return std::nullopt;
  const auto at = [&](double t) { return OutsideBy(scene, set, eye + t * sample.ray, own); };

  const double step = (end - begin) / kSteps;
  double least = kFar, depth = begin;
  std::vector<double> outside(kSteps + 1, kFar);
  for (int i = 0; i <= kSteps; ++i) {
    outside[i] = at(begin + i * step).value_or(kFar);
    if (outside[i] < least) {
      least = outside[i];
      depth = begin + i * step;
    }
  }
  if (least >= kFar) return std::nullopt;
  for (int halvings = 1; halvings < kFinerSteps; ++halvings) {
    const double finer = std::ldexp(step, -halvings);
    for (double t : {depth - finer, depth + finer})
      if (const auto d = at(t); d && *d < least) {
        least = *d;
        depth = t;
      }
  }
  // The ends lie between two steps: OutsideBy grows no faster than the way.
  const auto edge = [&](double sign) {
    double t = depth;
    for (int halvings = 0; halvings < 4; ++halvings) {
      const double width = std::ldexp(step, -halvings);
      while (t + sign * width > begin && t + sign * width < end) {
        const auto d = at(t + sign * width);
        if (!d || *d > least + slack) break;
        t += sign * width;
      }
    }
    return t;
  };
  sample.depth = depth;
  sample.near = edge(-1);
  sample.far = edge(1);
  sample.depth = std::clamp((sample.near + sample.far) / 2, sample.near, sample.far);
  return least;
}

}  // namespace glint::internal
