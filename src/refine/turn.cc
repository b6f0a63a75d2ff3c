#include "refine/turn.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

namespace glint {

double LargestTurn(const LevelSet& field, const Eigen::Vector3d& x, const Eigen::Vector3d& normal, double reach) {
  const Eigen::Vector3d u = normal.unitOrthogonal(), v = normal.cross(u);
  const std::array<Eigen::Vector3d, 4> ways = {u, v, (u + v).normalized(), (u - v).normalized()};
  double largest = 0;
  for (const Eigen::Vector3d& way : ways) {
    const Eigen::Vector3d a = field.Gradient(x + reach * way), b = field.Gradient(x - reach * way);
    largest = std::max(largest, std::atan2(a.cross(b).norm(), a.dot(b)));
  }
  return largest;
}

}  // namespace glint
