#include "highlights/mirror_test.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace glint {
namespace {

constexpr double kDarkWidths = 1.7;  // where a GGX lobe is down to a fifth
constexpr double kPeakVariance = 2.4;
constexpr double kMinCos = 0.2;
constexpr double kMinWidthDeg = 1, kMaxWidthDeg = 15;  // as far as a seed can tell

double AngleDeg(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) * 180 / M_PI;
}

}  // namespace

double PeakGain(double cos_incidence) {
  constexpr double kReflectance = 0.04;
  const double cos = std::clamp(cos_incidence, 0.05, 1.0);
  return (1 + (1 / kReflectance - 1) * std::pow(1 - cos, 5)) / cos;
}

MirrorTest::MirrorTest(const View& own, const SeedSurface& surface, const Light& light, const Highlight& highlight,
                       const SurfaceSample& at)
    : surface_(surface), light_(light), correction_(HalfVector(light, own.cam_from_world, at.position) - at.normal) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(highlight.moments_px);
  double product = 1;
  for (int k = 0; k < 2; ++k) {
    const double sigma = std::sqrt(axes.eigenvalues()[k]);
    const Eigen::Vector2d half_height = 2 * sigma * axes.eigenvectors().col(k);
    const auto ahead = Look(own, highlight.px + half_height), behind = Look(own, highlight.px - half_height);
    double turn_deg = 0, count = 0;
    for (const auto& place : {ahead, behind})
      if (place) turn_deg += place->off_deg, ++count;
    product *= count > 0 ? turn_deg / count : 0;
    if (!ahead || !behind) continue;
    // Near its peak a GGX lobe is a Gaussian whose variance is kPeakVariance of its second moment above half height.
    const double slope =
        std::log(std::max(behind->view_cos, kMinCos) / std::max(ahead->view_cos, kMinCos)) / (4 * sigma);
    const double shift = kPeakVariance * sigma * sigma * slope;
    peak_shift_px_ += std::clamp(shift, -sigma, sigma) * axes.eigenvectors().col(k);
  }
  width_deg_ = std::clamp(std::sqrt(product), kMinWidthDeg, kMaxWidthDeg);
}

double MirrorTest::DarkDeg() const { return kDarkWidths * width_deg_; }

std::optional<MirrorTest::Place> MirrorTest::Look(const View& view, const Eigen::Vector2d& px) const {
  const auto ray = view.RayThrough(px);
  const auto hit = ray ? surface_.Meet(view.Center(), *ray) : std::nullopt;
  if (!hit) return std::nullopt;
  const Eigen::Vector3d normal = (hit->normal + correction_).normalized();
  return Place{AngleDeg(HalfVector(light_, view.cam_from_world, hit->position), normal), -normal.dot(*ray)};
}

std::optional<double> MirrorTest::OffDeg(const View& view, const Eigen::Vector2d& px) const {
  const auto place = Look(view, px);
  return place ? std::optional<double>(place->off_deg) : std::nullopt;
}

}  // namespace glint
