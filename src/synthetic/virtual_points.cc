#include "synthetic/virtual_points.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "synthetic/true_highlights.h"

namespace glint {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kMaxErrorPx = 3;       // COLMAP filters at 4 px, an observation
constexpr double kSameHighlight = 0.6;  // contacts of one highlight in neighbouring views lie that near

// Lit highlights of every view.
std::vector<std::vector<TrueHighlight>> AllHighlights(const Stage& stage) {
  std::vector<std::vector<TrueHighlight>> all(stage.views.size());
  ParallelFor(stage.views.size(), 1, [&](size_t v) {
    for (size_t l = 0; l < stage.lights.size(); ++l)
      for (const TrueHighlight& h :
           FindTrueHighlights(stage, stage.views[v], l, MakeLobeMap(stage, stage.views[v], l, 4)))
        if (h.lit) all[v].push_back(h);
  });
  return all;
}

// The views nearest to `view`, it first.
std::vector<size_t> Neighbours(const Stage& stage, size_t view) {
  std::vector<size_t> order(stage.views.size());
  for (size_t v = 0; v < order.size(); ++v) order[v] = v;
  std::vector<double> distance;
  for (const StageView& v : stage.views) distance.push_back((v.Center() - stage.views[view].Center()).norm());
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return distance[a] < distance[b]; });
  return order;
}

const TrueHighlight* NearestContact(const std::vector<TrueHighlight>& highlights, const TrueHighlight& to) {
  const TrueHighlight* best = nullptr;
  double least = kSameHighlight;
  for (const TrueHighlight& h : highlights) {
    const double distance = (h.position - to.position).norm();
    if (h.light == to.light && distance < least) best = &h, least = distance;
  }
  return best;
}

// Nearest point to the rays through the observations.
Vector3d MeetingPoint(const Stage& stage, const std::vector<SyntheticObservation>& observations) {
  Eigen::Matrix3d matrix = Eigen::Matrix3d::Zero();
  Vector3d right = Vector3d::Zero();
  for (const SyntheticObservation& o : observations) {
    const StageView& view = stage.views[o.view];
    const Vector3d direction = *view.RayThrough(o.px);
    const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - direction * direction.transpose();
    matrix += across;
    right += across * view.Center();
  }
  return matrix.ldlt().solve(right);
}

}  // namespace

bool Triangulate(const Stage& stage, SyntheticPoint& point) {
  constexpr double kDelta = 1e-5;
  Vector3d x = point.position;
  for (int iteration = 0; iteration < 10; ++iteration) {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Vector3d gradient = Vector3d::Zero();
    for (const SyntheticObservation& o : point.observations) {
      const StageView& view = stage.views[o.view];
      const auto px = view.Project(x);
      if (!px) return false;
      Eigen::Matrix<double, 2, 3> jacobian;
      for (int k = 0; k < 3; ++k) {
        const auto ahead = view.Project(x + kDelta * Vector3d::Unit(k));
        if (!ahead) return false;
        jacobian.col(k) = (*ahead - *px) / kDelta;
      }
      normal += jacobian.transpose() * jacobian;
      gradient += jacobian.transpose() * (*px - o.px);
    }
    const Vector3d step = normal.ldlt().solve(gradient);
    if (!step.allFinite()) return false;
    x -= step;
    if (step.norm() < 1e-9) break;
  }
  point.error_px = 0;
  for (const SyntheticObservation& o : point.observations) {
    const auto px = stage.views[o.view].Project(x);
    if (!px) return false;
    point.error_px += (*px - o.px).norm() / static_cast<double>(point.observations.size());
  }
  point.position = x;
  return true;
}

std::vector<SyntheticPoint> MakeVirtualPoints(const Stage& stage, size_t count, double noise_px) {
  std::vector<SyntheticPoint> points;
  if (count == 0) return points;
  const auto all = AllHighlights(stage);
  Random random({stage.seed, 51});
  for (size_t tries = 0; tries < 50 * count && points.size() < count; ++tries) {
    const auto view = static_cast<size_t>(random.Index(static_cast<int>(stage.views.size())));
    if (all[view].empty()) continue;
    const TrueHighlight& first = all[view][random.Index(static_cast<int>(all[view].size()))];
    if (first.strength < 0.3) continue;
    SyntheticPoint point{SyntheticPoint::Origin::kHighlight, first.position, first.position, {250, 250, 248}, 0, {}};
    const size_t length = 3 + random.Index(3);
    for (size_t neighbour : Neighbours(stage, view)) {
      const TrueHighlight* seen = neighbour == view ? &first : NearestContact(all[neighbour], first);
      const Vector2d noise(random.Normal(), random.Normal());
      if (seen) point.observations.push_back({neighbour, seen->px + noise_px * noise});
      if (point.observations.size() == length) break;
    }
    while (point.observations.size() >= 3) {
      point.position = MeetingPoint(stage, point.observations);
      if (Triangulate(stage, point) && point.error_px < kMaxErrorPx) break;
      point.observations.pop_back();
    }
    if (point.observations.size() < 3) continue;
    std::sort(point.observations.begin(), point.observations.end(),
              [](const auto& a, const auto& b) { return a.view < b.view; });
    points.push_back(std::move(point));
  }
  return points;
}

}  // namespace glint
