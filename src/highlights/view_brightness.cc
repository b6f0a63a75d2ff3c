#include "highlights/view_brightness.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/check.h"
#include "core/parallel.h"
#include "highlights/brightness.h"

namespace glint {

ViewBrightness::ViewBrightness(const ImageSource& images, size_t memory_bytes, Progress& progress)
    : maps_(images.size()), masks_(images.size()), sizes_(images.size(), 1), exposures_(images.size(), 1) {
  const size_t bytes_a_view = memory_bytes / std::max<size_t>(images.size(), 1);
  progress.Begin("Brightness of the views", images.size());
  ParallelFor(images.size(), 1, [&](size_t view) {
    progress.ThrowIfCancelled();
    cv::Mat image, mask;
    if (images.Load(view, image)) {
      cv::Mat map = LinearMinChannel(image);
      if (!images.LoadMask(view, mask)) mask.release();
      while (map.total() * 3 > bytes_a_view && std::min(map.cols, map.rows) > 64) {
        cv::resize(map, map, {map.cols / 2, map.rows / 2}, 0, 0, cv::INTER_AREA);
        sizes_[view] *= 2;
      }
      if (!mask.empty() && mask.size() != map.size()) cv::resize(mask, mask, map.size(), 0, 0, cv::INTER_NEAREST);
      maps_[view] = map;
      masks_[view] = mask;
    }
    progress.Advance();
  });
}

void ViewBrightness::Equalise(std::vector<double> exposures) {
  GLINT_CHECK_EQ(exposures.size(), maps_.size());
  exposures_ = std::move(exposures);
}

cv::Rect ViewBrightness::Window(size_t view, const Eigen::Vector2d& px, double radius_px) const {
  const cv::Mat& map = maps_[view];
  const cv::Mat& mask = masks_[view];
  const double x = px.x() / sizes_[view] - 0.5, y = px.y() / sizes_[view] - 0.5;
  const double r = std::max(radius_px / sizes_[view], 0.5);
  if (map.empty() || x < 0 || y < 0 || x > map.cols - 1 || y > map.rows - 1) return {};
  if (!mask.empty() && !mask.at<uint8_t>(static_cast<int>(std::lround(y)), static_cast<int>(std::lround(x)))) return {};
  const int x0 = std::max(0, static_cast<int>(std::ceil(x - r)));
  const int x1 = std::min(map.cols - 1, static_cast<int>(std::floor(x + r)));
  const int y0 = std::max(0, static_cast<int>(std::ceil(y - r)));
  const int y1 = std::min(map.rows - 1, static_cast<int>(std::floor(y + r)));
  return {x0, y0, x1 - x0 + 1, y1 - y0 + 1};
}

std::optional<double> ViewBrightness::MaxNear(size_t view, const Eigen::Vector2d& px, double radius_px) const {
  const cv::Rect window = Window(view, px, radius_px);
  if (window.empty()) return std::nullopt;
  uint16_t best = 0;
  for (int v = window.y; v < window.y + window.height; ++v) {
    const uint16_t* row = maps_[view].ptr<uint16_t>(v) + window.x;
    best = std::max(best, *std::max_element(row, row + window.width));
  }
  return best / 65535.0 / exposures_[view];
}

std::optional<double> ViewBrightness::MeanNear(size_t view, const Eigen::Vector2d& px, double radius_px) const {
  const cv::Rect window = Window(view, px, radius_px);
  if (window.empty()) return std::nullopt;
  return cv::mean(maps_[view](window))[0] / 65535.0 / exposures_[view];
}

std::optional<double> ViewBrightness::MedianAround(size_t view, const Eigen::Vector2d& px,
                                                   const Eigen::Matrix2d& moments_px) const {
  constexpr int kSamples = 24;
  const cv::Mat& map = maps_[view];
  if (map.empty()) return std::nullopt;
  const Eigen::Matrix2d root = moments_px.llt().matrixL();
  std::vector<uint16_t> values;
  for (int k = 0; k < kSamples; ++k) {
    const double a = 2 * M_PI * k / kSamples;
    const Eigen::Vector2d offset = root * Eigen::Vector2d(std::cos(a), std::sin(a));
    const Eigen::Vector2d at = (px + 3 * offset + 1.5 * sizes_[view] * offset.normalized()) / sizes_[view];
    const int x = static_cast<int>(std::floor(at.x())), y = static_cast<int>(std::floor(at.y()));
    if (x < 0 || y < 0 || x >= map.cols || y >= map.rows) continue;
    if (!masks_[view].empty() && !masks_[view].at<uint8_t>(y, x)) continue;
    values.push_back(map.at<uint16_t>(y, x));
  }
  if (values.empty()) return std::nullopt;
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2] / 65535.0 / exposures_[view];
}

}  // namespace glint
