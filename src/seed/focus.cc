#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/check.h"
#include "core/median.h"
#include "core/square.h"
#include "seed/scene_layout.h"

namespace glint {
namespace {

struct Axis {
  Eigen::Vector3d center, direction;  // unit
  double depth = -1;                  // median of the view's points; -1: unknown
};

std::vector<Axis> OpticalAxes(const Scene& scene, const std::vector<uint8_t>& use) {
  std::vector<Axis> axes;
  for (const View& view : scene.views)
    axes.push_back({view.Center(), view.cam_from_world.rotation.conjugate() * Eigen::Vector3d::UnitZ()});
  std::vector<std::vector<double>> depths(axes.size());
  for (size_t i = 0; i < scene.points.size(); ++i) {
    if (!use[i]) continue;
    for (const Observation& o : scene.points[i].observations)
      depths[o.view].push_back((scene.points[i].position - axes[o.view].center).dot(axes[o.view].direction));
  }
  for (size_t v = 0; v < axes.size(); ++v)
    if (!depths[v].empty()) axes[v].depth = Median(std::move(depths[v]));
  return axes;
}

}  // namespace

Focus FindFocus(const Scene& scene, const std::vector<uint8_t>& use) {
  GLINT_CHECK(!scene.views.empty());
  GLINT_CHECK_EQ(use.size(), scene.points.size());
  constexpr double kDepthWeight = 0.02;  // of a view's depth, against its axis
  const std::vector<Axis> axes = OpticalAxes(scene, use);
  std::vector<double> weights(axes.size(), 1.0);
  Focus focus;
  for (int iteration = 0; iteration < 10; ++iteration) {
    Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
    Eigen::Vector3d b = Eigen::Vector3d::Zero();
    for (size_t v = 0; v < axes.size(); ++v) {
      const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - axes[v].direction * axes[v].direction.transpose();
      a += weights[v] * across;
      b += weights[v] * across * axes[v].center;
      if (axes[v].depth > 0) {
        a += kDepthWeight * weights[v] * Eigen::Matrix3d::Identity();
        b += kDepthWeight * weights[v] * (axes[v].center + axes[v].depth * axes[v].direction);
      }
    }
    focus.center = a.ldlt().solve(b);
    std::vector<double> off(axes.size());
    for (size_t v = 0; v < axes.size(); ++v) off[v] = (focus.center - axes[v].center).cross(axes[v].direction).norm();
    const double scale = std::max(Median(off), std::numeric_limits<double>::min());
    for (size_t v = 0; v < axes.size(); ++v) weights[v] = 1 / (1 + Square(off[v] / (2 * scale)));
  }
  std::vector<double> distances;
  for (const Axis& axis : axes) distances.push_back((focus.center - axis.center).norm());
  focus.distance = Median(std::move(distances));
  return focus;
}

}  // namespace glint
