#include "refine/outline_contacts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>

#include "core/parallel.h"

namespace glint {
namespace {

// Of an outline's direction in the photograph: pixels make it jagged.
constexpr double kSigmaNormal = 3 * M_PI / 180;
constexpr double kLeastSigma = 0.0005;
constexpr double kReach = 0.02;  // decides the footprint over which the normal is taken
constexpr size_t kEvery = 4;     // sample along an outline, where they are half a per cent of the diagonal apart
// Of places on the outlines: how well they are known along their rays, how far apart, and across their rays (outlines
// in photographs are a pixel or so off). Fractions of the diagonal.
constexpr double kMaxInterval = 0.05, kCell = 0.01, kPlaceSigma = 0.002;
// The ray is looked at in steps of so many voxels.
constexpr double kStepVoxels = 0.5;

// Depth of the field's least value on the ray; nothing where that is an end of [near, far], or off the band.
std::optional<double> LeastOn(const OutlineRay& sample, const LevelSet& field) {
  const double step = kStepVoxels * field.voxel_size();
  const int count = static_cast<int>((sample.far - sample.near) / step) + 1;
  int best = -1;
  double least = (field.half_width_voxels() - 1) * field.voxel_size();
  const double deepest = -least;
  for (int k = 0; k <= count; ++k) {
    const double value = field.Value(sample.eye + (sample.near + k * step) * sample.ray);
    if (value >= least) continue;
    least = value;
    best = k;
  }
  if (best <= 0 || best >= count || least <= deepest) return std::nullopt;
  return sample.near + best * step;
}

}  // namespace

std::vector<OutlineRay> RaysOf(const Scene& scene, const std::vector<OutlineSample>& outline, const UnitFrame& frame) {
  std::vector<OutlineRay> rays;
  for (size_t i = 0; i < outline.size(); i += kEvery) {
    const OutlineSample& s = outline[i];
    rays.push_back({frame.FromWorld(scene.views[s.view].Center()), s.ray, s.normal, frame.scale * s.near,
                    frame.scale * s.far, frame.scale * s.sigma});
  }
  return rays;
}

std::vector<OrientedPoint> OutlineContacts(const std::vector<OutlineRay>& outline, const LevelSet& surface) {
  std::vector<std::optional<OrientedPoint>> found(outline.size());
  ParallelFor(outline.size(), 64, [&](size_t i) {
    const OutlineRay& sample = outline[i];
    const std::optional<double> depth = LeastOn(sample, surface);
    if (!depth) return;
    OrientedPoint p;
    p.bundle_position = sample.eye + *depth * sample.ray;
    const Eigen::Vector3d gradient = surface.Gradient(p.bundle_position);
    if (gradient.norm() < 0.5) return;
    p.position = p.bundle_position - surface.Value(p.bundle_position) * gradient.normalized();
    p.normal = sample.normal;
    // Another part of the surface, which this ray does not touch.
    if (gradient.normalized().dot(p.normal) < 0.5) return;
    p.sigma_position = std::max(sample.sigma, kLeastSigma);
    p.sigma_normal = kSigmaNormal;
    p.reach = kReach;
    found[i] = p;
  });
  std::vector<OrientedPoint> contacts;
  for (const std::optional<OrientedPoint>& p : found)
    if (p) contacts.push_back(*p);
  return contacts;
}

std::vector<SurfacePoint> KnownOutlinePlaces(const Scene& scene, const std::vector<OutlineSample>& outline,
                                             const UnitFrame& frame) {
  struct Known {
    double interval;
    SurfacePoint place;
  };
  std::map<std::array<int64_t, 3>, Known> cells;
  for (const OutlineSample& s : outline) {
    const double interval = frame.scale * (s.far - s.near);
    if (interval > kMaxInterval) continue;
    SurfacePoint p;
    p.position = frame.FromWorld(scene.views[s.view].Center() + s.depth * s.ray);
    p.normal = s.normal;
    p.sigma = std::max(frame.scale * s.sigma, kPlaceSigma);
    std::array<int64_t, 3> cell;
    for (int k = 0; k < 3; ++k) cell[k] = static_cast<int64_t>(std::floor(p.position[k] / kCell));
    const auto [it, fresh] = cells.try_emplace(cell, Known{interval, p});
    if (!fresh && interval < it->second.interval) it->second = {interval, p};
  }
  std::vector<SurfacePoint> places;
  for (const auto& [cell, known] : cells) places.push_back(known.place);
  return places;
}

}  // namespace glint
