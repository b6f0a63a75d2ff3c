#include "highlights/view_maps.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/parallel.h"

namespace glint {

ViewMaps::ViewMaps(const ImageSource& images, const std::function<cv::Mat(const cv::Mat&)>& map_from_image,
                   size_t memory_bytes, const std::string& what, Progress& progress)
    : maps_(images.size()), masks_(images.size()), sizes_(images.size(), 1) {
  const size_t bytes_a_view = memory_bytes / std::max<size_t>(images.size(), 1);
  progress.Begin(what, images.size());
  ParallelFor(images.size(), 1, [&](size_t view) {
    progress.ThrowIfCancelled();
    cv::Mat image, mask;
    if (images.Load(view, image)) {
      cv::Mat map = map_from_image(image);
      if (!images.LoadMask(view, mask)) mask.release();
      while (map.total() * (map.elemSize() + 1) > bytes_a_view && std::min(map.cols, map.rows) > 64) {
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

cv::Rect ViewMaps::Window(size_t view, const Eigen::Vector2d& px, double radius_px) const {
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

}  // namespace glint
