// Small brightness maps of all views, to look at one surface point in many of them.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "core/progress.h"
#include "highlights/view_maps.h"
#include "io/image_source.h"

namespace glint {

// Linear minimum over the channels of every view. Immutable, thread-safe.
class ViewBrightness {
 public:
  // Streams the images once; views without an image stay empty.
  ViewBrightness(const ImageSource& images, size_t memory_bytes, Progress& progress);

  bool Has(size_t view) const { return !maps_.map(view).empty(); }

  // From now on values are divided by these factors, one a view (exposure.h).
  void Equalise(std::vector<double> exposures);
  double Exposure(size_t view) const { return exposures_[view]; }

  // Largest value (1 = sensor white) within `radius_px` image pixels of a pixel in COLMAP's frame; nullopt off the
  // image or where the mask ignores it.
  std::optional<double> MaxNear(size_t view, const Eigen::Vector2d& px, double radius_px) const;

  // Mean over the same pixels.
  std::optional<double> MeanNear(size_t view, const Eigen::Vector2d& px, double radius_px) const;

  // Median on an ellipse: three standard deviations of `moments_px` around `px`. nullopt if all of it is off the image.
  std::optional<double> MedianAround(size_t view, const Eigen::Vector2d& px, const Eigen::Matrix2d& moments_px) const;

  // Image pixels a map pixel is wide.
  double PixelSize(size_t view) const { return maps_.PixelSize(view); }

 private:
  ViewMaps maps_;  // CV_16UC1, 65535 = sensor white
  std::vector<double> exposures_;
};

}  // namespace glint
