#include "highlights/seed_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace glint {
namespace {

constexpr size_t kMaxPoints = 20000;
constexpr size_t kNeighbours = 6;
// A smooth surface leaves the facets between its points by much less than the points are apart.
constexpr double kErrorOfSpread = 0.5;

}  // namespace

std::vector<Eigen::Vector3d> SmoothNormals(const TriangleMesh& mesh) {
  constexpr int kRounds = 3;
  std::vector<Eigen::Vector3d> normals(mesh.vertices.size(), Eigen::Vector3d::Zero());
  for (const auto& f : mesh.faces) {
    const Eigen::Vector3d n =
        (mesh.vertices[f[1]] - mesh.vertices[f[0]]).cross(mesh.vertices[f[2]] - mesh.vertices[f[0]]);
    for (int k = 0; k < 3; ++k) normals[f[k]] += n;
  }
  for (auto& n : normals) n = n.stableNormalized();
  for (int round = 0; round < kRounds; ++round) {
    std::vector<Eigen::Vector3d> next = normals;
    for (const auto& f : mesh.faces)
      for (int k = 0; k < 3; ++k) next[f[k]] += 0.5 * (normals[f[(k + 1) % 3]] + normals[f[(k + 2) % 3]]);
    for (auto& n : next) n = n.stableNormalized();
    normals = std::move(next);
  }
  return normals;
}

SeedSurface::SeedSurface(const TriangleMesh& mesh, const std::vector<ScenePoint>& points, double max_error_world)
    : faces_(mesh.faces),
      normals_(SmoothNormals(mesh)),
      caster_(mesh),
      center_(BoundingBox(mesh).center()),
      diagonal_(Diagonal(mesh)),
      max_error_world_(max_error_world) {
  for (const auto& [name, values] : mesh.scalars)
    if (name == kFineScalar) fine_.assign(values.begin(), values.end());
  const size_t stride = points.size() / kMaxPoints + 1;
  for (size_t i = 0; i < points.size(); i += stride) points_.push_back(points[i].position);
  spacing_scale_ = std::sqrt(1.0 / stride);
}

double SeedSurface::SpreadAt(const Eigen::Vector3d& x) const {
  std::array<double, kNeighbours> nearest;  // squared, ascending
  nearest.fill(std::numeric_limits<double>::infinity());
  for (const auto& p : points_) {
    double d = (p - x).squaredNorm();
    for (double& n : nearest)
      if (d < n) std::swap(d, n);
  }
  const double spacing = spacing_scale_ * std::sqrt(nearest.back());
  return std::clamp(spacing, 0.1 * max_error_world_ / kErrorOfSpread, max_error_world_ / kErrorOfSpread);
}

std::optional<SurfaceSample> SeedSurface::Meet(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const {
  const auto hit = caster_.Intersect(origin, direction);
  if (!hit) return std::nullopt;
  const Eigen::Vector3i& f = faces_[hit->face];
  Eigen::Vector3d normal = (1 - hit->u - hit->v) * normals_[f[0]] + hit->u * normals_[f[1]] + hit->v * normals_[f[2]];
  if (normal.norm() < 1e-6) normal = hit->normal;
  SurfaceSample sample{hit->position, normal.normalized()};
  for (int k = 0; k < 3 && !fine_.empty(); ++k) sample.fine |= fine_[f[k]] != 0;
  return sample;
}

std::vector<SurfaceSample> SeedSurface::Neighbourhood(const Eigen::Vector3d& origin,
                                                      const Eigen::Vector3d& direction) const {
  std::vector<SurfaceSample> samples;
  const auto central = Meet(origin, direction);
  const double spread_world = central ? SpreadAt(central->position) : max_error_world_ / kErrorOfSpread;
  if (central && central->normal.dot(direction) < 0) samples.push_back(*central);
  const double depth = central ? (central->position - origin).norm() : (center_ - origin).dot(direction);
  if (!(depth > 0)) return samples;
  const Eigen::Vector3d e1 = direction.unitOrthogonal(), e2 = direction.cross(e1);
  for (const double radius : {0.35, 0.7, 1.0}) {
    const int count = radius < 0.5 ? 6 : 10;
    for (int k = 0; k < count; ++k) {
      const double a = 2 * M_PI * (k + radius) / count;
      const Eigen::Vector3d offset = radius * spread_world * (std::cos(a) * e1 + std::sin(a) * e2);
      auto sample = Meet(origin, (depth * direction + offset).normalized());
      // What lies far in front or behind is another part of the surface.
      if (!sample || sample->normal.dot(direction) >= 0) continue;
      if (central && std::abs((sample->position - origin).norm() - depth) > 4 * spread_world) continue;
      sample->off_center = radius;
      samples.push_back(*sample);
    }
  }
  for (SurfaceSample& s : samples) {
    s.spread_world = spread_world;
    s.error_world = kErrorOfSpread * spread_world;
  }
  return samples;
}

bool SeedSurface::Occluded(const SurfaceSample& from, const Eigen::Vector3d& to) const {
  // Starting off the surface by its error keeps rays that graze the seed's bumps from being stopped by them.
  return caster_.Occluded(from.position + from.error_world * from.normal, to, from.error_world);
}

}  // namespace glint
