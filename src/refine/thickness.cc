#include "refine/thickness.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/parallel.h"
#include "geometry/ray_caster.h"
#include "refine/turn.h"

namespace glint {
namespace {

constexpr double kShare = 0.02;
constexpr double kOffsetRel = 1e-4;  // of the diagonal: rays start this far inside
constexpr size_t kMostSamples = 20000;
constexpr double kSharpVoxels = 1.5, kSharpTurn = M_PI / 3;
constexpr double kWallVoxels = 6;
constexpr double kReachVoxels = 3;

}  // namespace

double ThinnestWalls(const TriangleMesh& mesh) {
  const RayCaster caster(mesh);
  const double offset = kOffsetRel * Diagonal(mesh);
  const size_t stride = std::max<size_t>(1, mesh.faces.size() / kMostSamples);
  struct Sample {
    double thickness, area;
  };
  std::vector<Sample> samples((mesh.faces.size() + stride - 1) / stride);
  ParallelFor(samples.size(), 64, [&](size_t i) {
    const Eigen::Vector3i& f = mesh.faces[i * stride];
    const Eigen::Vector3d &a = mesh.vertices[f[0]], &b = mesh.vertices[f[1]], &c = mesh.vertices[f[2]];
    const Eigen::Vector3d across = (b - a).cross(c - a), inward = -across.normalized();
    samples[i] = {std::numeric_limits<double>::infinity(), across.norm()};
    if (!(samples[i].area > 0)) return;
    if (const auto hit = caster.Intersect((a + b + c) / 3, inward, offset)) samples[i].thickness = hit->t;
  });
  std::sort(samples.begin(), samples.end(), [](const Sample& a, const Sample& b) { return a.thickness < b.thickness; });
  double area = 0, below = 0;
  for (const Sample& s : samples) area += s.area;
  for (const Sample& s : samples)
    if ((below += s.area) >= kShare * area) return s.thickness;
  return std::numeric_limits<double>::infinity();
}

Unresolved::Unresolved(const TriangleMesh& surface, const LevelSet& field, const std::vector<Eigen::Vector3d>& fine)
    : reach_(kReachVoxels * field.voxel_size()) {
  if (fine.empty()) return;
  const RayCaster caster(surface);
  const PointIndex near(fine);
  const double wall = kWallVoxels * field.voxel_size(), inside = 0.5 * field.voxel_size();
  std::vector<uint8_t> unresolved(surface.vertices.size());
  ParallelFor(unresolved.size(), 256, [&](size_t v) {
    const Eigen::Vector3d& x = surface.vertices[v];
    if ((fine[near.Nearest(x, 1)[0]] - x).norm() > wall) return;
    const Eigen::Vector3d gradient = field.Gradient(x);
    // None halfway between two sides: such a wall has no voxel of its own.
    if (!(gradient.norm() > 0)) {
      unresolved[v] = 1;
      return;
    }
    const Eigen::Vector3d normal = gradient.normalized();
    unresolved[v] = caster.Intersect(x - inside * normal, -normal, 0, wall) ||
                    LargestTurn(field, x, normal, kSharpVoxels * field.voxel_size()) > kSharpTurn;
  });
  for (size_t v = 0; v < unresolved.size(); ++v)
    if (unresolved[v]) positions_.push_back(surface.vertices[v]);
  if (!positions_.empty()) places_.emplace(positions_);
}

bool Unresolved::Near(const Eigen::Vector3d& x) const {
  return places_ && (positions_[places_->Nearest(x, 1)[0]] - x).squaredNorm() < reach_ * reach_;
}

}  // namespace glint
