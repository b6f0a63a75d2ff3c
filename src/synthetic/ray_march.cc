#include "synthetic/ray_march.h"

#include <algorithm>
#include <cmath>

namespace glint {
namespace {

using Eigen::Vector3d;

constexpr int kMaxSteps = 400;

// The parameter at which the march comes within `near` of the surface; negative where it does not (Hart 1996).
double March(const ImplicitShape& shape, const Vector3d& origin, const Vector3d& direction, double t_min, double t_max,
             double near) {
  const auto [enter, leave] = ClipToBounds(shape, origin, direction);
  const double end = std::min(t_max, leave);
  double t = std::max(t_min, enter);
  for (int i = 0; i < kMaxSteps && t < end; ++i) {
    const double value = shape.Value(origin + t * direction);
    if (value < near) return t;
    t += value;
  }
  return -1;
}

}  // namespace

std::pair<double, double> ClipToBounds(const ImplicitShape& shape, const Vector3d& origin, const Vector3d& direction) {
  const Vector3d to_center = shape.center() - origin;
  const double middle = to_center.dot(direction);
  const double radius = shape.radius() * 1.001;
  const double discriminant = radius * radius - (to_center - middle * direction).squaredNorm();
  if (discriminant < 0) return {1, 0};
  const double half = std::sqrt(discriminant);
  return {middle - half, middle + half};
}

ShapeHit PolishHit(const ImplicitShape& shape, const Vector3d& origin, const Vector3d& direction, double t) {
  Vector3d x = origin + t * direction, gradient = shape.Gradient(x);
  for (int i = 0; i < 5; ++i) {
    const double slope = gradient.dot(direction);
    if (slope > -0.02 * gradient.norm()) break;  // grazing: near enough as it is
    const double step = -shape.Value(x) / slope;
    if (std::abs(step) > 0.01 * shape.radius()) break;
    x = origin + (t += step) * direction;
    gradient = shape.Gradient(x);
    if (std::abs(step) < 1e-8 * shape.radius()) break;  // quadratic: the next step would be lost in rounding
  }
  return {t, x, gradient.normalized()};
}

std::optional<ShapeHit> TraceRay(const ImplicitShape& shape, const Vector3d& origin, const Vector3d& direction,
                                 double t_min, double t_max) {
  const double t = March(shape, origin, direction, t_min, t_max, kNearSurface * shape.radius());
  if (t < 0) return std::nullopt;
  return PolishHit(shape, origin, direction, t);
}

bool RayMeets(const ImplicitShape& shape, const Vector3d& origin, const Vector3d& direction, double t_min,
              double t_max) {
  return March(shape, origin, direction, t_min, t_max, kTouching * shape.radius()) >= 0;
}

Vector3d ProjectToSurface(const ImplicitShape& shape, const Vector3d& x) {
  Vector3d projected = x;
  for (int i = 0; i < 20; ++i) {
    const Vector3d gradient = shape.Gradient(projected);
    const double squared = gradient.squaredNorm();
    if (squared == 0) break;
    const Vector3d step = shape.Value(projected) / squared * gradient;
    projected -= step;
    if (step.norm() < 1e-13 * shape.radius()) break;
  }
  return projected;
}

}  // namespace glint
