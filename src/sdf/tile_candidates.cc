#include "sdf/tile_candidates.h"

#include <algorithm>
#include <cmath>

#include "core/check.h"

namespace glint::internal {

namespace {

constexpr double kHalf = 3.5;

// The least value of (x − c)² − 2 h |x − q| over [low, high].
double LeastAlong(double low, double high, double c, double q) {
  double least = std::numeric_limits<double>::infinity();
  const auto at = [&](double x) { least = std::min(least, (x - c) * (x - c) - 2 * kHalf * std::abs(x - q)); };
  at(low), at(high);
  if (c + kHalf > q) at(std::clamp(c + kHalf, low, high));  // on the side x > q
  if (c - kHalf < q) at(std::clamp(c - kHalf, low, high));
  return least;
}

}  // namespace

double TileCandidates::Collect(const Eigen::Vector3i& origin, double bound, std::vector<uint32_t>& triangles) const {
  triangles.clear();
  const Eigen::Vector3d c = origin.cast<double>() + Eigen::Vector3d::Constant(kHalf);
  const auto q = closest_->Find(c, bound);
  GLINT_CHECK(q.has_value());
  const double limit = q->squared_distance * (1 + 1e-9) + 1e-9;
  const std::vector<Bvh::Node>& nodes = closest_->bvh().nodes();
  const std::vector<uint32_t>& faces = closest_->bvh().faces();
  uint32_t stack[96];
  int top = 0;
  stack[top++] = 0;
  while (top > 0) {
    const uint32_t index = stack[--top];
    const Bvh::Node& node = nodes[index];
    double least = 0;
    for (int k = 0; k < 3; ++k) least += LeastAlong(node.min[k], node.max[k], c[k], q->point[k]);
    if (least > limit) continue;
    if (node.count > 0) {
      triangles.insert(triangles.end(), faces.begin() + node.first, faces.begin() + node.first + node.count);
      continue;
    }
    stack[top++] = node.right;
    stack[top++] = index + 1;
  }
  return std::sqrt(q->squared_distance);
}

}  // namespace glint::internal
