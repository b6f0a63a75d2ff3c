#include "highlights/tint.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "highlights/brightness.h"

namespace glint {
namespace {

Eigen::Vector3d ColorAt(const cv::Mat& image, const Eigen::Vector2i& px) {
  const int x = std::clamp(px.x(), 0, image.cols - 1), y = std::clamp(px.y(), 0, image.rows - 1);
  const auto c = LinearColor(image, x, y);
  return {c[0], c[1], c[2]};
}

// Median by channel on the ellipse three standard deviations from the blob's centre.
Eigen::Vector3d SurroundingColor(const cv::Mat& image, const Blob& blob) {
  constexpr int kSamples = 24;
  const Eigen::Matrix2d root = blob.moments.llt().matrixL();
  std::array<std::array<double, kSamples>, 3> channel;
  for (int k = 0; k < kSamples; ++k) {
    const double a = 2 * M_PI * k / kSamples;
    const Eigen::Vector2d offset = root * Eigen::Vector2d(std::cos(a), std::sin(a));
    const Eigen::Vector2d at = blob.centroid + 3.2 * offset + 1.5 * offset.normalized();
    const Eigen::Vector3d c = ColorAt(image, (std::ldexp(1.0, blob.level) * at).array().round().cast<int>());
    for (int i = 0; i < 3; ++i) channel[i][k] = c[i];
  }
  Eigen::Vector3d color;
  for (int i = 0; i < 3; ++i) {
    std::nth_element(channel[i].begin(), channel[i].begin() + kSamples / 2, channel[i].end());
    color[i] = channel[i][kSamples / 2];
  }
  return color;
}

// Angle between `added` and the nearest non-negative mixture of `white` and `body`, radians.
double AngleToMixture(const Eigen::Vector3d& added, const Eigen::Vector3d& white, const Eigen::Vector3d& body) {
  double best = -1;  // cosine
  constexpr int kSteps = 8;
  for (int k = 0; k <= kSteps; ++k) {
    const double t = double(k) / kSteps;
    const Eigen::Vector3d mixture = ((1 - t) * white + t * body).normalized();
    best = std::max(best, mixture.dot(added));
  }
  return std::acos(std::clamp(best, -1.0, 1.0));
}

}  // namespace

std::optional<double> TintDegrees(const cv::Mat& image_bgr, const Blob& blob, double saturation) {
  if (image_bgr.channels() == 1) return std::nullopt;
  const Eigen::Vector3d body = SurroundingColor(image_bgr, blob);
  Eigen::Vector3d added = Eigen::Vector3d::Zero();
  size_t count = 0;
  const size_t stride = std::max<size_t>(1, blob.pixels.size() / 64);
  for (size_t i = 0; i < blob.pixels.size(); i += stride) {
    const Eigen::Vector3d c = ColorAt(image_bgr, blob.pixels[i] * (1 << blob.level));
    if (c.maxCoeff() >= saturation) continue;
    added += c - body;
    ++count;
  }
  if (count < 3 || added.norm() < 1e-6) return std::nullopt;
  const Eigen::Vector3d white = Eigen::Vector3d::Constant(1 / std::sqrt(3.0));
  const double norm = body.norm();
  return AngleToMixture(added.normalized(), white, norm > 1e-3 ? Eigen::Vector3d(body / norm) : white) * 180 / M_PI;
}

}  // namespace glint
