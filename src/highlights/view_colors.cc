#include "highlights/view_colors.h"

#include <opencv2/core.hpp>

#include "highlights/brightness.h"
#include "highlights/view_maps.h"

namespace glint {

namespace {
constexpr double kCutOff = 0.98;
}

ViewColors::ViewColors(const ImageSource& images, size_t memory_bytes, Progress& progress)
    : maps_(std::make_unique<ViewMaps>(images, LinearColors, memory_bytes, "colours of the views", progress)) {}

ViewColors::~ViewColors() = default;

bool ViewColors::Has(size_t view) const { return !maps_->map(view).empty(); }

std::optional<Eigen::Array3d> ViewColors::Mean(size_t view, const Eigen::Vector2d& px, double radius_px) const {
  const cv::Rect window = maps_->Window(view, px, radius_px);
  if (window.empty()) return std::nullopt;
  const cv::Scalar mean = cv::mean(maps_->map(view)(window)) / 65535.0;
  const Eigen::Array3d rgb(mean[2], mean[1], mean[0]);
  if (rgb.maxCoeff() > kCutOff) return std::nullopt;
  return rgb;
}

}  // namespace glint
