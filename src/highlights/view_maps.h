// Small maps of all views, so that one surface point can be looked at in many of them.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "core/progress.h"
#include "io/image_source.h"

namespace glint {

// Immutable, thread-safe.
class ViewMaps {
 public:
  // Streams the images once; views without an image stay empty. `map_from_image` must keep the size; its maps are
  // halved as often as needed for all of them to fit the memory.
  ViewMaps(const ImageSource& images, const std::function<cv::Mat(const cv::Mat&)>& map_from_image, size_t memory_bytes,
           const std::string& what, Progress& progress);

  size_t size() const { return maps_.size(); }
  const cv::Mat& map(size_t view) const { return maps_[view]; }
  const cv::Mat& mask(size_t view) const { return masks_[view]; }  // CV_8UC1 of the same size, or empty

  // Image pixels a map pixel is wide.
  double PixelSize(size_t view) const { return sizes_[view]; }

  // The map's pixels within so many image pixels of one in COLMAP's frame; empty off the image or where the mask
  // ignores it.
  cv::Rect Window(size_t view, const Eigen::Vector2d& px, double radius_px) const;

 private:
  std::vector<cv::Mat> maps_, masks_;
  std::vector<double> sizes_;
};

}  // namespace glint
