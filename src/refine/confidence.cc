#include "refine/confidence.h"

#include <cmath>
#include <utility>
#include <vector>

#include "core/check.h"
#include "core/square.h"

namespace glint {
namespace {

constexpr double kDegrees = 180 / M_PI;
constexpr double kHalfConfidenceDeg = 5;

}  // namespace

void AddConfidence(const SurfaceDeviation& deviation, TriangleMesh& mesh) {
  const size_t n = mesh.vertices.size();
  GLINT_CHECK_EQ(deviation.normal.size(), n);
  std::vector<float> sigma_normal_deg(n);
  mesh.confidence.resize(n);
  for (size_t v = 0; v < n; ++v) {
    sigma_normal_deg[v] = static_cast<float>(deviation.normal[v] * kDegrees);
    mesh.confidence[v] = static_cast<float>(1 / (1 + Square(sigma_normal_deg[v] / kHalfConfidenceDeg)));
  }
  mesh.scalars.emplace_back("sigma_position_rel", deviation.position);
  mesh.scalars.emplace_back("sigma_normal_deg", std::move(sigma_normal_deg));
}

}  // namespace glint
