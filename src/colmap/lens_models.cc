#include "colmap/lens_models.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

namespace glint::internal {
namespace {

constexpr double kPi = std::numbers::pi;

}  // namespace

Plane FisheyePlane(const Eigen::Vector3d& x) {
  const double across = x.head<2>().norm();
  if (across == 0) return x.z() > 0 ? Plane(Eigen::Vector2d::Zero()) : std::nullopt;
  return Eigen::Vector2d(x.head<2>() * (std::atan2(across, x.z()) / across));
}

Ray FisheyeRay(const Eigen::Vector2d& plane) {
  const double angle = plane.norm();
  if (angle >= kPi) return std::nullopt;
  const double sinc = angle < 1e-8 ? 1 : std::sin(angle) / angle;
  return Eigen::Vector3d(plane.x() * sinc, plane.y() * sinc, std::cos(angle));
}

Plane FovPlane(double omega, const Eigen::Vector3d& x) {
  if (!(x.z() > 0)) return std::nullopt;
  const Eigen::Vector2d plane = x.head<2>() / x.z();
  const double r = plane.norm(), widening = 2 * std::tan(omega / 2);
  if (std::abs(omega) < 1e-9) return plane;
  if (r * std::abs(widening) < 1e-9) return Eigen::Vector2d(plane * (widening / omega));
  return Eigen::Vector2d(plane * (std::atan(r * widening) / (r * omega)));
}

Ray FovRay(double omega, const Eigen::Vector2d& plane) {
  const double r = plane.norm(), widening = 2 * std::tan(omega / 2);
  if (std::abs(omega) < 1e-9) return plane.homogeneous();
  if (r * std::abs(omega) >= kPi / 2) return std::nullopt;
  const double factor = r * std::abs(omega) < 1e-9 ? omega / widening : std::tan(r * omega) / (r * widening);
  return Eigen::Vector2d(plane * factor).homogeneous();
}

Plane DivisionPlane(double k, const Eigen::Vector3d& x) {
  const double across2 = x.head<2>().squaredNorm(), z = x.z();
  const double discriminant = z * z - 4 * k * across2;
  if (discriminant < 0) return std::nullopt;
  const double root = std::sqrt(discriminant);
  if (z > 0) return Eigen::Vector2d(x.head<2>() * (2 / (z + root)));
  if (k >= 0 || across2 == 0) return std::nullopt;
  return Eigen::Vector2d(x.head<2>() * ((root - z) / (-2 * k * across2)));  // as above, without cancellation
}

Ray DivisionRay(double k, const Eigen::Vector2d& plane) {
  const double bend = k * plane.squaredNorm();
  if (bend >= 1) return std::nullopt;  // beyond it the angle from the axis falls again
  return Eigen::Vector3d(plane.x(), plane.y(), 1 + bend);
}

Plane EucmPlane(double alpha, double beta, const Eigen::Vector3d& x) {
  const double distance = std::sqrt(beta * x.head<2>().squaredNorm() + x.z() * x.z());
  const double horizon = alpha <= 0.5 ? alpha / (1 - alpha) : (1 - alpha) / alpha;
  if (!(x.z() > -horizon * distance)) return std::nullopt;
  return Eigen::Vector2d(x.head<2>() / (alpha * distance + (1 - alpha) * x.z()));
}

Ray EucmRay(double alpha, double beta, const Eigen::Vector2d& plane) {
  const double r2 = beta * plane.squaredNorm();
  const double radicand = 1 - (2 * alpha - 1) * r2;
  if (!(radicand > 0)) return std::nullopt;
  const double z = (1 - alpha * alpha * r2) / (alpha * std::sqrt(radicand) + 1 - alpha);
  return Eigen::Vector3d(plane.x(), plane.y(), z);
}

Plane EquirectangularPixel(double width, double height, const Eigen::Vector3d& x) {
  if (x.squaredNorm() == 0) return std::nullopt;
  const double longitude = std::atan2(x.x(), x.z());
  const double latitude_down = std::atan2(x.y(), std::hypot(x.x(), x.z()));
  return Eigen::Vector2d((longitude / (2 * kPi) + 0.5) * width, (latitude_down / kPi + 0.5) * height);
}

Ray EquirectangularRay(double width, double height, const Eigen::Vector2d& px) {
  const double longitude = 2 * kPi * (px.x() / width - 0.5), latitude_down = kPi * (px.y() / height - 0.5);
  if (std::abs(latitude_down) > kPi / 2) return std::nullopt;
  const double across = std::cos(latitude_down);
  return Eigen::Vector3d(across * std::sin(longitude), std::sin(latitude_down), across * std::cos(longitude));
}

}  // namespace glint::internal
