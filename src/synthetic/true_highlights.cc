#include "synthetic/true_highlights.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "synthetic/shading.h"

namespace glint {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kConverged = 1e-9;

std::optional<ShapeHit> HitThrough(const Stage& stage, const StageView& view, const Vector2d& px) {
  const auto ray = view.RayThrough(px);
  if (!ray) return std::nullopt;
  return stage.tracer->Trace(view.Center(), *ray, 0, 1e6);
}

// Components of (half vector - normal) along two fixed axes across the normal.
struct Mismatch {
  ShapeHit hit;
  Vector2d residual;
};

class PeakSolver {
 public:
  PeakSolver(const Stage& stage, const StageView& view, size_t light)
      : stage_(stage), view_(view), light_(stage.lights[light].light) {}

  // Gauss-Newton over the pixel, from `px`.
  std::optional<std::pair<Vector2d, ShapeHit>> Solve(Vector2d px, double max_shift_px) {
    const auto start = HitThrough(stage_, view_, px);
    if (!start) return std::nullopt;
    axis_u_ = start->normal.unitOrthogonal();
    axis_v_ = start->normal.cross(axis_u_);
    const Vector2d first = px;
    auto current = Evaluate(px);
    for (int i = 0; i < 40 && current; ++i) {
      if (current->residual.norm() < kConverged) return std::make_pair(px, current->hit);
      const auto step = Step(px, *current);
      if (!step) return std::nullopt;
      Vector2d shift = -*step;
      if (shift.norm() > 5) shift *= 5 / shift.norm();
      std::optional<Mismatch> next;
      for (int halving = 0; halving < 12; ++halving, shift *= 0.5) {
        next = Evaluate(px + shift);
        if (next && next->residual.norm() < current->residual.norm()) break;
        next.reset();
      }
      if (!next) return std::nullopt;
      px += shift;
      current = next;
      if ((px - first).norm() > max_shift_px) return std::nullopt;
    }
    return std::nullopt;
  }

 private:
  std::optional<Mismatch> Evaluate(const Vector2d& px) const {
    const auto hit = HitThrough(stage_, view_, px);
    if (!hit) return std::nullopt;
    const Vector3d d = HalfVector(light_, view_.cam_from_stage, hit->position) - hit->normal;
    return Mismatch{*hit, {d.dot(axis_u_), d.dot(axis_v_)}};
  }

  std::optional<Vector2d> Step(const Vector2d& px, const Mismatch& at) const {
    constexpr double kDelta = 1e-3;
    Eigen::Matrix2d jacobian;
    for (int k = 0; k < 2; ++k) {
      const auto ahead = Evaluate(px + kDelta * Vector2d::Unit(k));
      const auto behind = Evaluate(px - kDelta * Vector2d::Unit(k));
      if (!ahead || !behind) return std::nullopt;
      jacobian.col(k) = (ahead->residual - behind->residual) / (2 * kDelta);
    }
    const Eigen::FullPivLU<Eigen::Matrix2d> lu(jacobian);
    if (!lu.isInvertible()) return std::nullopt;
    return Vector2d(lu.solve(at.residual));
  }

  const Stage& stage_;
  const StageView& view_;
  const Light& light_;
  Vector3d axis_u_, axis_v_;
};

bool IsPeak(const LobeMap& map, int x, int y) {
  const float value = map.cosine[static_cast<size_t>(y) * map.width + x];
  if (value < 0.97f) return false;  // no nearer than 14 degrees: no peak at hand
  for (int dy = -1; dy <= 1; ++dy)
    for (int dx = -1; dx <= 1; ++dx) {
      const int nx = x + dx, ny = y + dy;
      if (nx < 0 || ny < 0 || nx >= map.width || ny >= map.height) continue;
      if (map.cosine[static_cast<size_t>(ny) * map.width + nx] > value) return false;
    }
  return true;
}

}  // namespace

LobeMap MakeLobeMap(const Stage& stage, const StageView& view, size_t light, double stride) {
  LobeMap map;
  map.stride = stride;
  map.width = static_cast<int>(static_cast<double>(view.camera.width) / stride);
  map.height = static_cast<int>(static_cast<double>(view.camera.height) / stride);
  map.cosine.resize(static_cast<size_t>(map.width) * map.height, -1);
  for (int y = 0; y < map.height; ++y)
    for (int x = 0; x < map.width; ++x) {
      const auto hit = HitThrough(stage, view, stride * Vector2d(x + 0.5, y + 0.5));
      if (!hit) continue;
      const Vector3d half = HalfVector(stage.lights[light].light, view.cam_from_stage, hit->position);
      map.cosine[static_cast<size_t>(y) * map.width + x] = static_cast<float>(half.dot(hit->normal));
    }
  return map;
}

std::vector<TrueHighlight> FindTrueHighlights(const Stage& stage, const StageView& view, size_t light,
                                              const LobeMap& map) {
  std::vector<TrueHighlight> found;
  PeakSolver solver(stage, view, light);
  for (int y = 0; y < map.height; ++y)
    for (int x = 0; x < map.width; ++x) {
      if (!IsPeak(map, x, y)) continue;
      const auto peak = solver.Solve(map.stride * Vector2d(x + 0.5, y + 0.5), 30 * map.stride);
      if (!peak || !view.Contains(peak->first)) continue;
      const bool known = std::any_of(found.begin(), found.end(),
                                     [&](const TrueHighlight& other) { return (other.px - peak->first).norm() < 0.5; });
      if (known) continue;
      const ShapeHit& hit = peak->second;
      const Vector3d to_light = DirectionToLight(stage.lights[light].light, view.cam_from_stage, hit.position);
      const double distance = stage.lights[light].Distance(view.cam_from_stage, hit.position);
      TrueHighlight highlight;
      highlight.px = peak->first;
      highlight.position = hit.position;
      highlight.normal = hit.normal;
      highlight.light = static_cast<int>(light);
      highlight.lit = stage.Visibility({SurfaceKind::kObject, hit.t, hit.position, hit.normal}, to_light, distance) > 0;
      highlight.strength = SpecularLobe(stage, light, view.cam_from_stage, hit.position, hit.normal,
                                        (view.Center() - hit.position).normalized())
                               .maxCoeff();
      found.push_back(highlight);
    }
  return found;
}

}  // namespace glint
