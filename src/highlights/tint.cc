#include "highlights/tint.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "highlights/brightness.h"
#include "highlights/samples_around.h"

namespace glint {
namespace {

constexpr double kWhite = 65535;
constexpr int kInside = 64;  // pixels of the blob that are looked at

// Linear colours, 65535 = sensor white.
class Colors {
 public:
  explicit Colors(const cv::Mat& image) : read_(image), size_(image.size()) {}

  std::array<uint16_t, 3> At(double x, double y) const {
    return read_(std::clamp(static_cast<int>(std::lround(x)), 0, size_.width - 1),
                 std::clamp(static_cast<int>(std::lround(y)), 0, size_.height - 1));
  }

 private:
  LinearColorReader read_;
  cv::Size size_;
};

const std::array<Eigen::Vector2d, SamplesAround::kMost>& Directions() {
  static const auto directions = [] {
    std::array<Eigen::Vector2d, SamplesAround::kMost> all;
    for (size_t k = 0; k < all.size(); ++k) {
      const double a = 2 * M_PI * static_cast<double>(k) / static_cast<double>(all.size());
      all[k] = {std::cos(a), std::sin(a)};
    }
    return all;
  }();
  return directions;
}

// Median by channel on the ellipse three standard deviations from the blob's centre.
Eigen::Vector3d SurroundingColor(const Colors& colors, const Blob& blob) {
  const Eigen::Matrix2d root = blob.moments.llt().matrixL();
  const double scale = std::ldexp(1.0, blob.level);
  // All places first: what is read there is far away in memory, and the reads need not wait for each other.
  std::array<Eigen::Vector2d, SamplesAround::kMost> places;
  for (size_t k = 0; k < places.size(); ++k) {
    const Eigen::Vector2d offset = root * Directions()[k];
    places[k] = scale * (blob.centroid + (3.2 + 1.5 / offset.norm()) * offset);
  }
  std::array<SamplesAround, 3> channels;
  for (const Eigen::Vector2d& place : places) {
    const auto color = colors.At(place.x(), place.y());
    for (size_t i = 0; i < 3; ++i) channels[i].Put(color[i]);
  }
  constexpr size_t kMiddle = SamplesAround::kMost / 2;
  return {double(channels[0].Ranked(kMiddle)), double(channels[1].Ranked(kMiddle)),
          double(channels[2].Ranked(kMiddle))};
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
  const Colors colors(image_bgr);
  const auto most = static_cast<uint16_t>(kWhite * saturation);
  const int stride = std::max(1, blob.area / kInside);
  int skip = 0;  // pixels until the next that is looked at
  std::array<int64_t, 3> sum = {0, 0, 0};
  int count = 0;
  for (const PixelRun& run : blob.runs) {
    for (; skip < run.length; skip += stride) {
      const auto color = colors.At((run.x + skip) << blob.level, run.y << blob.level);
      if (std::max({color[0], color[1], color[2]}) >= most) continue;
      for (size_t i = 0; i < 3; ++i) sum[i] += color[i];
      ++count;
    }
    skip -= run.length;
  }
  if (count < 3) return std::nullopt;
  const Eigen::Vector3d body = SurroundingColor(colors, blob);
  const Eigen::Vector3d added = Eigen::Vector3d(double(sum[0]), double(sum[1]), double(sum[2])) / count - body;
  if (added.norm() < 1e-6 * kWhite) return std::nullopt;
  const Eigen::Vector3d white = Eigen::Vector3d::Constant(1 / std::sqrt(3.0));
  const double norm = body.norm();
  return AngleToMixture(added.normalized(), white, norm > 1e-3 * kWhite ? Eigen::Vector3d(body / norm) : white) * 180 /
         M_PI;
}

}  // namespace glint
