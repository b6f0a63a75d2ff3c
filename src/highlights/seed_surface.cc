#include "highlights/seed_surface.h"

#include <cmath>

namespace glint {
namespace {

// Area-weighted vertex normals, smoothed over the one-ring a few times: the facets of a sparse seed are off by tens of
// degrees one by one, much less on average.
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

}  // namespace

SeedSurface::SeedSurface(const TriangleMesh& mesh, double error_world)
    : faces_(mesh.faces),
      normals_(SmoothNormals(mesh)),
      caster_(mesh),
      center_(BoundingBox(mesh).center()),
      diagonal_(Diagonal(mesh)),
      error_world_(error_world) {}

std::optional<SurfaceSample> SeedSurface::Hit(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const {
  const auto hit = caster_.Intersect(origin, direction);
  if (!hit) return std::nullopt;
  const Eigen::Vector3i& f = faces_[hit->face];
  Eigen::Vector3d normal = (1 - hit->u - hit->v) * normals_[f[0]] + hit->u * normals_[f[1]] + hit->v * normals_[f[2]];
  if (normal.norm() < 1e-6) normal = hit->normal;
  return SurfaceSample{hit->position, normal.normalized()};
}

std::vector<SurfaceSample> SeedSurface::Neighbourhood(const Eigen::Vector3d& origin,
                                                      const Eigen::Vector3d& direction) const {
  std::vector<SurfaceSample> samples;
  const auto central = Hit(origin, direction);
  if (central && central->normal.dot(direction) < 0) samples.push_back(*central);
  const double depth = central ? (central->position - origin).norm() : (center_ - origin).dot(direction);
  if (!(depth > 0)) return samples;
  const Eigen::Vector3d e1 = direction.unitOrthogonal(), e2 = direction.cross(e1);
  for (const double radius : {0.35, 0.7, 1.0}) {
    const int count = radius < 0.5 ? 6 : 10;
    for (int k = 0; k < count; ++k) {
      const double a = 2 * M_PI * (k + radius) / count;
      const Eigen::Vector3d offset = radius * error_world_ * (std::cos(a) * e1 + std::sin(a) * e2);
      const auto sample = Hit(origin, (depth * direction + offset).normalized());
      // What lies far in front or behind is another part of the surface.
      if (!sample || sample->normal.dot(direction) >= 0) continue;
      if (central && std::abs((sample->position - origin).norm() - depth) > 4 * error_world_) continue;
      samples.push_back(*sample);
    }
  }
  return samples;
}

bool SeedSurface::Occluded(const Eigen::Vector3d& from, const Eigen::Vector3d& to) const {
  return caster_.Occluded(from, to, 2 * error_world_);
}

}  // namespace glint
