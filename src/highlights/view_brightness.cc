#include "highlights/view_brightness.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>

#include "core/check.h"
#include "highlights/brightness.h"

namespace glint {

ViewBrightness::ViewBrightness(const ImageSource& images, size_t memory_bytes, Progress& progress)
    : maps_(images, LinearMinChannel, memory_bytes, "brightness of the views", progress),
      exposures_(images.size(), 1) {}

void ViewBrightness::Equalise(std::vector<double> exposures) {
  GLINT_CHECK_EQ(exposures.size(), maps_.size());
  exposures_ = std::move(exposures);
}

std::optional<double> ViewBrightness::MaxNear(size_t view, const Eigen::Vector2d& px, double radius_px) const {
  const cv::Rect window = maps_.Window(view, px, radius_px);
  if (window.empty()) return std::nullopt;
  uint16_t best = 0;
  for (int v = window.y; v < window.y + window.height; ++v) {
    const uint16_t* row = maps_.map(view).ptr<uint16_t>(v) + window.x;
    best = std::max(best, *std::max_element(row, row + window.width));
  }
  return best / 65535.0 / exposures_[view];
}

std::optional<double> ViewBrightness::MeanNear(size_t view, const Eigen::Vector2d& px, double radius_px) const {
  const cv::Rect window = maps_.Window(view, px, radius_px);
  if (window.empty()) return std::nullopt;
  return cv::mean(maps_.map(view)(window))[0] / 65535.0 / exposures_[view];
}

std::optional<double> ViewBrightness::MedianAround(size_t view, const Eigen::Vector2d& px,
                                                   const Eigen::Matrix2d& moments_px) const {
  constexpr int kSamples = 24;
  const cv::Mat& map = maps_.map(view);
  const cv::Mat& mask = maps_.mask(view);
  const double size = maps_.PixelSize(view);
  if (map.empty()) return std::nullopt;
  const Eigen::Matrix2d root = moments_px.llt().matrixL();
  std::vector<uint16_t> values;
  for (int k = 0; k < kSamples; ++k) {
    const double a = 2 * M_PI * k / kSamples;
    const Eigen::Vector2d offset = root * Eigen::Vector2d(std::cos(a), std::sin(a));
    const Eigen::Vector2d at = (px + 3 * offset + 1.5 * size * offset.normalized()) / size;
    const int x = static_cast<int>(std::floor(at.x())), y = static_cast<int>(std::floor(at.y()));
    if (x < 0 || y < 0 || x >= map.cols || y >= map.rows) continue;
    if (!mask.empty() && !mask.at<uint8_t>(y, x)) continue;
    values.push_back(map.at<uint16_t>(y, x));
  }
  if (values.empty()) return std::nullopt;
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2] / 65535.0 / exposures_[view];
}

}  // namespace glint
