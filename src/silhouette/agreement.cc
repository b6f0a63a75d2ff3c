#include "silhouette/agreement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

namespace glint::internal {
namespace {

constexpr int kSteps = 40;  // through the ball
constexpr int kFinerSteps = 8;
constexpr int kMaxContradictions = 8;

// By how much a mask has x outside, world units; nothing where it does not know of x.
std::optional<double> OutsideOf(const Scene& scene, const ViewMask& mask, const Eigen::Vector3d& x) {
  const View& view = scene.views[mask.view];
  const auto px = view.Project(x);
  if (!px) return std::nullopt;
  const auto distance_px = mask.DistanceAt(view, *px);
  if (!distance_px) return std::nullopt;
  return *distance_px * (x - mask.eye).norm() / mask.focal_px;
}

// The masks that judge a place, those that lately excluded one first: mostly they exclude its neighbour, too, and the
// rest need not be asked.
class Witnesses {
 public:
  Witnesses(const Scene& scene, const MaskSet& set, int skip)
      : scene_(scene), set_(set), count_(std::clamp(set.contradictions, 1, kMaxContradictions)) {
    for (int m = 0; m < static_cast<int>(set.masks.size()); ++m)
      if (m != skip) order_.push_back(m);
  }

  // As OutsideBy; nothing, too, where it is more than `most`.
  std::optional<double> OutsideBy(const Eigen::Vector3d& x, double most) {
    std::array<double, kMaxContradictions> worst;
    worst.fill(-kFar);
    size_t witnesses = 0;
    int above = 0;
    for (size_t i = 0; i < order_.size(); ++i) {
      const std::optional<double> outside = OutsideOf(scene_, set_.masks[order_[i]], x);
      if (!outside) continue;
      ++witnesses;
      double d = *outside;
      if (d > most) {
        std::swap(order_[i], order_[above]);
        if (++above == count_) return std::nullopt;
      }
      for (int k = 0; k < count_; ++k)
        if (d > worst[k]) std::swap(d, worst[k]);
    }
    if (witnesses < kMinWitnesses) return std::nullopt;
    return worst[count_ - 1];
  }

 private:
  const Scene& scene_;
  const MaskSet& set_;
  int count_;
  std::vector<int> order_;
};

}  // namespace

std::optional<double> OutsideBy(const Scene& scene, const MaskSet& set, const Eigen::Vector3d& x) {
  return Witnesses(scene, set, -1).OutsideBy(x, std::numeric_limits<double>::infinity());
}

std::optional<double> OutsideByMost(const Scene& scene, const std::vector<ViewMask>& masks, const Eigen::Vector3d& x,
                                    double wrong_share) {
  std::vector<double> distances;
  for (const ViewMask& mask : masks)
    if (const auto d = OutsideOf(scene, mask, x)) distances.push_back(*d);
  if (distances.size() < kMinWitnesses || 2 * distances.size() < masks.size()) return std::nullopt;
  const auto wrong = static_cast<size_t>(wrong_share * static_cast<double>(distances.size()));
  std::nth_element(distances.begin(), distances.begin() + wrong, distances.end(), std::greater<>());
  return distances[wrong];
}

std::optional<double> SeenThroughBy(const Scene& scene, const MaskSet& set, size_t views, const Eigen::Vector3d& x) {
  std::vector<double> depths;
  for (const ViewMask& mask : set.masks) {
    if (mask.hole.empty()) continue;
    if (const auto px = scene.views[mask.view].Project(x))
      depths.push_back(-mask.HoleDistanceAt(*px) * (x - mask.eye).norm() / mask.focal_px);
  }
  if (depths.size() < views || views == 0) return std::nullopt;
  const auto last = depths.begin() + static_cast<ptrdiff_t>(views - 1);
  std::nth_element(depths.begin(), last, depths.end(), std::greater<>());
  return *last;
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
  Witnesses witnesses(scene, set, own);
  const auto at = [&](double t, double most) { return witnesses.OutsideBy(eye + t * sample.ray, most); };

  const double step = (end - begin) / kSteps;
  double least = kFar, depth = begin;
  const auto look = [&](double t) {
    if (const auto d = at(t, least); d && *d < least) {
      least = *d;
      depth = t;
    }
  };
  for (int i = 0; i <= kSteps; ++i) look(begin + i * step);
  if (least >= kFar) return std::nullopt;
  for (int halvings = 1; halvings < kFinerSteps; ++halvings) {
    const double finer = std::ldexp(step, -halvings);
    for (double t : {depth - finer, depth + finer}) look(t);
  }
  // The ends lie between two steps: OutsideBy grows no faster than the way.
  const auto edge = [&](double sign) {
    double t = depth;
    for (int halvings = 0; halvings < 4; ++halvings) {
      const double width = std::ldexp(step, -halvings);
      while (t + sign * width > begin && t + sign * width < end) {
        if (!at(t + sign * width, least + slack)) break;
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
