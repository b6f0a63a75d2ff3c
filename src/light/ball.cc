#include "light/ball.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "core/median.h"
#include "core/square.h"

namespace glint {
namespace {

constexpr int kRounds = 10;

}  // namespace

std::optional<Ball> BallFromOutline(const Camera& camera, const std::vector<Eigen::Vector2d>& outline_px) {
  std::vector<Eigen::Vector3d> rays;
  for (const Eigen::Vector2d& px : outline_px)
    if (const auto ray = BearingOfPixel(camera, px)) rays.push_back(*ray);
  if (rays.size() < 5) return std::nullopt;
  std::vector<double> weights(rays.size(), 1);
  Eigen::Vector3d w = Eigen::Vector3d::Zero();
  for (int round = 0; round < kRounds; ++round) {
    Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
    Eigen::Vector3d b = Eigen::Vector3d::Zero();
    for (size_t i = 0; i < rays.size(); ++i) {
      a += weights[i] * rays[i] * rays[i].transpose();
      b += weights[i] * rays[i];
    }
    const Eigen::Vector3d spread = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(a).eigenvalues();
    if (spread[0] < 1e-12 * spread[2]) return std::nullopt;
    w = a.ldlt().solve(b);
    if (!w.allFinite()) return std::nullopt;
    std::vector<double> errors;
    for (const Eigen::Vector3d& ray : rays) errors.push_back(std::abs(ray.dot(w) - 1));
    const double scale = std::max(3 * Median(errors), 1e-12);
    for (size_t i = 0; i < rays.size(); ++i) weights[i] = 1 / (1 + Square(errors[i] / scale));
  }
  const double cos_alpha = 1 / w.norm();
  if (!(cos_alpha < 1)) return std::nullopt;
  return Ball{w.normalized() / std::sqrt(1 - cos_alpha * cos_alpha)};
}

std::optional<Ball> BallFromCircle(const Camera& camera, const Eigen::Vector2d& center_px, double radius_px) {
  constexpr int kSamples = 72;
  std::vector<Eigen::Vector2d> outline;
  for (int k = 0; k < kSamples; ++k) {
    const double a = 2 * M_PI * k / kSamples;
    outline.push_back(center_px + radius_px * Eigen::Vector2d(std::cos(a), std::sin(a)));
  }
  return BallFromOutline(camera, outline);
}

std::optional<Eigen::Vector3d> BallNormal(const Camera& camera, const Ball& ball, const Eigen::Vector2d& px) {
  const auto ray = BearingOfPixel(camera, px);
  if (!ray) return std::nullopt;
  const double along = ray->dot(ball.center), off = ball.center.squaredNorm() - along * along;
  if (along <= 0 || off >= 1) return std::nullopt;
  return Eigen::Vector3d((along - std::sqrt(1 - off)) * *ray - ball.center).normalized();
}

std::optional<Eigen::Vector3d> MirroredDirection(const Camera& camera, const Ball& ball, const Eigen::Vector2d& px) {
  const auto normal = BallNormal(camera, ball, px);
  if (!normal) return std::nullopt;
  const Eigen::Vector3d v = -*BearingOfPixel(camera, px);
  return Eigen::Vector3d(2 * normal->dot(v) * *normal - v).normalized();
}

std::optional<ShadingFit> LightFromShading(const std::vector<ShadedPixel>& pixels) {
  constexpr size_t kFewest = 50;
  // Brightness as (a, g): a + g·n, g the light times the albedo, over what faces the light.
  Eigen::Vector4d fit = Eigen::Vector4d::Zero();
  Eigen::Matrix4d normal_matrix;
  double scale = 0, squares = 0, total = 0;
  size_t used = 0;
  for (int round = 0; round < kRounds; ++round) {
    const Eigen::Vector3d g = fit.tail<3>();
    std::vector<double> errors;
    for (const ShadedPixel& p : pixels)
      if (round > 0 && p.normal.dot(g) > 0.1 * g.norm())
        errors.push_back(std::abs(fit[0] + g.dot(p.normal) - p.brightness));
    if (round > 0 && errors.size() < kFewest) return std::nullopt;
    scale = errors.empty() ? 0 : std::max(2.5 * Median(errors), 1e-6);
    normal_matrix.setZero();
    Eigen::Vector4d b = Eigen::Vector4d::Zero();
    squares = total = 0, used = 0;
    for (const ShadedPixel& p : pixels) {
      double weight = round == 0 ? p.brightness * p.brightness : 0;  // the lit side before anything is known
      if (round > 0 && p.normal.dot(g) > 0.1 * g.norm()) {
        const double e = fit[0] + g.dot(p.normal) - p.brightness;
        weight = 1 / (1 + e * e / (scale * scale));
        squares += weight * e * e;
        ++used;
      }
      total += weight;
      const Eigen::Vector4d row(1, p.normal.x(), p.normal.y(), p.normal.z());
      normal_matrix += weight * row * row.transpose();
      b += weight * p.brightness * row;
    }
    // Ambient light and the component towards the camera are hard to tell apart where little of the ball is seen.
    normal_matrix(0, 0) += 1e-9 * std::max(total, 1e-300);
    fit = normal_matrix.ldlt().solve(b);
    if (!fit.allFinite()) return std::nullopt;
  }
  const Eigen::Vector3d g = fit.tail<3>();
  if (used < kFewest || !(g.norm() > 1e-6)) return std::nullopt;
  ShadingFit out;
  out.direction = g.normalized();
  out.ambient = fit[0] / g.norm();
  const double rms = std::sqrt(squares / std::max(total, 1e-12));
  out.residual = rms / g.norm();
  const Eigen::Matrix4d covariance = rms * rms * normal_matrix.inverse();
  const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - out.direction * out.direction.transpose();
  const Eigen::Matrix3d c = across * covariance.bottomRightCorner<3, 3>() * across / g.squaredNorm();
  // Neighbouring pixels err together: paint, dust and dents are some ten pixels wide.
  out.sigma_deg = 10 * std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(c).eigenvalues()[2]) * 180 / M_PI;
  return out;
}

}  // namespace glint
