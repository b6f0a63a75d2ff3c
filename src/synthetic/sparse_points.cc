#include "synthetic/sparse_points.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "synthetic/render.h"
#include "synthetic/shading.h"
#include "synthetic/virtual_points.h"

namespace glint {
namespace {

using Eigen::Array3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Origin = SyntheticPoint::Origin;

constexpr double kMaxObliqueness = 0.34;  // cosine: features at 70° and more are not matched
constexpr double kWashedOut = 0.25;       // of sensor white, by a highlight
constexpr double kMaxViewChange = 0.68;   // cosine of 47°: beyond, descriptors do not match
constexpr double kMatched = 0.85;         // of the views that could be
constexpr size_t kMinTrack = 3;

// Where a feature detector would find the point in the view.
std::optional<Vector2d> FeatureAt(const Stage& stage, const StageView& view, const SurfaceHit& point) {
  const Vector3d to_viewer = (view.Center() - point.position).normalized();
  if (to_viewer.dot(point.normal) < kMaxObliqueness) return std::nullopt;
  // Under a highlight the mark is washed out.
  if (point.kind == SurfaceKind::kObject)
    for (size_t l = 0; l < stage.lights.size(); ++l)
      if (SpecularLobe(stage, l, view.cam_from_stage, point.position, point.normal, to_viewer).maxCoeff() > kWashedOut)
        return std::nullopt;
  return stage.SeenAt(view, point);
}

std::array<uint8_t, 3> ColorOf(const Stage& stage, size_t view, const SurfaceHit& point) {
  const StageView& seen_by = stage.views[view];
  SurfaceHit hit = point;
  hit.t = (point.position - seen_by.Center()).norm();
  const Vector3d direction = (point.position - seen_by.Center()) / hit.t;
  const Array3d radiance = Shade(stage, seen_by, hit, direction, 0).radiance;
  std::array<uint8_t, 3> rgb;
  for (int c = 0; c < 3; ++c)
    rgb[c] = static_cast<uint8_t>(std::clamp(std::lround(SensorLevel(radiance[c])), 0l, 255l));
  return rgb;
}

Origin OriginOf(SurfaceKind kind) {
  return kind == SurfaceKind::kObject   ? Origin::kMark
         : kind == SurfaceKind::kGround ? Origin::kGround
                                        : Origin::kInterior;
}

// The track of one feature, or nothing if fewer than three views would match it.
std::optional<SyntheticPoint> MakeTrack(const Stage& stage, const SurfaceHit& feature, double noise_px, Random random) {
  std::vector<std::pair<size_t, Vector2d>> seen;
  for (size_t v = 0; v < stage.views.size(); ++v)
    if (const auto px = FeatureAt(stage, stage.views[v], feature)) seen.emplace_back(v, *px);
  if (seen.size() < kMinTrack) return std::nullopt;
  const size_t reference = seen[random.Index(static_cast<int>(seen.size()))].first;
  const Vector3d main = (stage.views[reference].Center() - feature.position).normalized();
  SyntheticPoint point{OriginOf(feature.kind), feature.position, feature.position, {}, 0, {}};
  for (const auto& [v, px] : seen) {
    const Vector3d toward = (stage.views[v].Center() - feature.position).normalized();
    const bool matched = random.Uniform() < kMatched;
    const Vector2d noise(random.Normal(), random.Normal());
    if (toward.dot(main) < kMaxViewChange || !(matched || v == reference)) continue;
    point.observations.push_back({v, px + noise_px * noise});
  }
  if (point.observations.size() < kMinTrack || !Triangulate(stage, point)) return std::nullopt;
  point.rgb = ColorOf(stage, reference, feature);
  return point;
}

// Features where the object is painted.
std::vector<SurfaceHit> ObjectFeatures(const Stage& stage) {
  std::vector<SurfaceHit> features;
  for (const Mark& mark : stage.marks.all())
    for (const Vector3d& x : MarkFeatures(*stage.shape, mark))
      features.push_back({SurfaceKind::kObject, 0, x, stage.shape->Normal(x)});
  return features;
}

// A place of the ground or the interior where its texture changes quickly.
std::optional<SurfaceHit> SampleTexture(const Stage& stage, Random& random) {
  const Surroundings& around = stage.surroundings;
  SurfaceHit hit;
  const double step = 0.02;
  Array3d change;
  if (around.interior() && random.Uniform() < 0.6) {
    const auto inside = SampleSurface(around.interior()->shape(), random);
    if (!inside || inside->normal.z() < 0.5) return std::nullopt;
    hit = {SurfaceKind::kInterior, 0, inside->position, inside->normal};
    const Vector3d x = hit.position, dx(step, 0, 0), dy(0, step, 0);
    const auto albedo = [&](const Vector3d& at) { return around.InteriorAlbedo(at, hit.normal, 0); };
    change = (albedo(x + dx) - albedo(x - dx)).abs() + (albedo(x + dy) - albedo(x - dy)).abs();
  } else {
    const double x = random.Uniform(-3, 3), y = random.Uniform(-3, 3);
    hit = {SurfaceKind::kGround, 0, {x, y, around.ground_z()}, Vector3d::UnitZ()};
    change = (around.GroundAlbedo(x + step, y, 0) - around.GroundAlbedo(x - step, y, 0)).abs() +
             (around.GroundAlbedo(x, y + step, 0) - around.GroundAlbedo(x, y - step, 0)).abs();
  }
  if (change.maxCoeff() < 0.12) return std::nullopt;
  return hit;
}

// The first `wanted` candidates that give a track; candidates are tried in parallel, taken in their order.
std::vector<SyntheticPoint> TakeTracks(const Stage& stage, const std::vector<SurfaceHit>& features, size_t wanted,
                                       double noise_px, uint64_t key) {
  std::vector<std::optional<SyntheticPoint>> tracks(features.size());
  ParallelFor(features.size(), 8, [&](size_t i) {
    tracks[i] = MakeTrack(stage, features[i], noise_px, Random({stage.seed, key, i}));
  });
  std::vector<SyntheticPoint> points;
  for (auto& track : tracks)
    if (track && points.size() < wanted) points.push_back(std::move(*track));
  return points;
}

// The asked share of them on the upper half.
std::vector<SyntheticPoint> ObjectPoints(const Stage& stage, const SyntheticOptions& options) {
  std::vector<SurfaceHit> features = ObjectFeatures(stage);
  Random random({stage.seed, 41});
  for (size_t i = features.size(); i > 1; --i) std::swap(features[i - 1], features[random.Index(static_cast<int>(i))]);
  const double median = stage.marks.median_height();
  std::vector<SurfaceHit> halves[2];
  for (const SurfaceHit& f : features) halves[f.position.z() > median].push_back(f);
  const auto upper = static_cast<size_t>(std::lround(options.glossy_share * options.object_points));
  std::vector<SyntheticPoint> points =
      TakeTracks(stage, halves[0], options.object_points - upper, options.point_noise_px, 42);
  for (SyntheticPoint& p : TakeTracks(stage, halves[1], upper, options.point_noise_px, 43))
    points.push_back(std::move(p));
  return points;
}

}  // namespace

std::vector<SyntheticPoint> MakeSparsePoints(const Stage& stage, const SyntheticOptions& options) {
  std::vector<SyntheticPoint> points = ObjectPoints(stage, options);
  std::vector<SurfaceHit> texture;
  Random random({stage.seed, 44});
  for (int tries = 0; tries < 200 * options.ground_points; ++tries) {
    if (texture.size() >= 2 * static_cast<size_t>(options.ground_points)) break;
    if (const auto hit = SampleTexture(stage, random)) texture.push_back(*hit);
  }
  for (SyntheticPoint& p : TakeTracks(stage, texture, options.ground_points, options.point_noise_px, 45))
    points.push_back(std::move(p));
  const auto count = static_cast<size_t>(std::lround(options.virtual_share * options.object_points));
  for (SyntheticPoint& p : MakeVirtualPoints(stage, count, options.point_noise_px)) points.push_back(std::move(p));
  return points;
}

}  // namespace glint
