#include "refine/confidence.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"

namespace glint {
namespace {

constexpr double kDegrees = 180 / M_PI;
// Where nothing is known the normal of a surface through sparse points is about this uncertain.
constexpr double kSeedNormalSigma = 20 / kDegrees;
// How fast a normal may deviate from the interpolated one with the distance from a constraint, radians a diagonal.
constexpr double kNormalDrift = 1.5;
// A vertex whose normal is known this well has a confidence of one half.
constexpr double kHalfConfidenceDeg = 5;

}  // namespace

void AddConfidence(const std::vector<OrientedPoint>& contacts, const std::vector<SurfacePoint>& points,
                   double seed_sigma_rel, TriangleMesh& mesh) {
  const size_t n = mesh.vertices.size();
  mesh.confidence.assign(n, 0);
  std::vector<float> sigma_position(n), sigma_normal(n);
  ParallelFor(n, 1 << 10, [&](size_t v) {
    double position = seed_sigma_rel, normal = kSeedNormalSigma;
    for (const OrientedPoint& c : contacts) {
      const double r = (mesh.vertices[v] - c.position).norm();
      if (kNormalDrift * r > kSeedNormalSigma) continue;
      const double n_here = std::hypot(c.sigma_normal, kNormalDrift * r);
      normal = std::min(normal, n_here);
      if (c.sigma_position > 0) position = std::min(position, std::hypot(c.sigma_position, 0.5 * r * n_here));
    }
    for (const SurfacePoint& p : points) {
      const double r = (mesh.vertices[v] - p.position).norm();
      position = std::min(position, std::hypot(p.sigma, r * kSeedNormalSigma));
    }
    sigma_position[v] = static_cast<float>(position);
    sigma_normal[v] = static_cast<float>(normal * kDegrees);
    mesh.confidence[v] = static_cast<float>(1 / (1 + std::pow(sigma_normal[v] / kHalfConfidenceDeg, 2)));
  });
  mesh.scalars.emplace_back("sigma_position_rel", std::move(sigma_position));
  mesh.scalars.emplace_back("sigma_normal_deg", std::move(sigma_normal));
}

}  // namespace glint
