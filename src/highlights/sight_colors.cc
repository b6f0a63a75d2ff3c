#include "highlights/sight_colors.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "highlights/brightness.h"
#include "highlights/view_maps.h"

namespace glint {
namespace {

constexpr double kBlurPx = 1.2;
constexpr float kCutOff = 0.98F;

cv::Mat Encoded(const cv::Mat& image) {
  cv::Mat linear = LinearColors(image), f;
  linear.convertTo(f, CV_32FC3, 1.0 / 65535);
  cv::sqrt(f, f);
  cv::GaussianBlur(f, f, {0, 0}, kBlurPx);
  cv::Mat out;
  f.convertTo(out, CV_16UC3, 65535);
  return out;
}

// At most so many of them, spread evenly.
class SomeImages : public ImageSource {
 public:
  SomeImages(const ImageSource& all, size_t most) : all_(all), chosen_(all.size(), 0) {
    const size_t count = std::min(all.size(), most);
    for (size_t i = 0; i < count; ++i) chosen_[(2 * i + 1) * all.size() / (2 * count)] = 1;
  }
  size_t size() const override { return all_.size(); }
  bool Load(size_t view, cv::Mat& image) const override { return chosen_[view] && all_.Load(view, image); }
  bool LoadMask(size_t view, cv::Mat& mask) const override { return chosen_[view] && all_.LoadMask(view, mask); }

 private:
  const ImageSource& all_;
  std::vector<uint8_t> chosen_;
};

}  // namespace

SightColors::SightColors(const ImageSource& images, size_t most_views, size_t memory_bytes, Progress& progress)
    : maps_(std::make_unique<ViewMaps>(
          SomeImages(images, most_views), Encoded,
          // It is shared out among all views, of which only these take their share.
          memory_bytes * std::max<size_t>(1, images.size() / std::max<size_t>(1, most_views)), "colours of the views",
          progress)) {}

SightColors::~SightColors() = default;

bool SightColors::Has(size_t view) const { return !maps_->map(view).empty(); }
double SightColors::PixelSize(size_t view) const { return maps_->PixelSize(view); }

std::optional<Eigen::Array3f> SightColors::At(size_t view, const Eigen::Vector2d& px) const {
  const cv::Mat& map = maps_->map(view);
  const double size = maps_->PixelSize(view);
  const double x = px.x() / size - 0.5, y = px.y() / size - 0.5;
  if (map.empty() || !(x >= 0 && y >= 0 && x <= map.cols - 1 && y <= map.rows - 1)) return std::nullopt;
  const int x0 = std::min(static_cast<int>(x), std::max(map.cols - 2, 0)), x1 = std::min(x0 + 1, map.cols - 1);
  const int y0 = std::min(static_cast<int>(y), std::max(map.rows - 2, 0)), y1 = std::min(y0 + 1, map.rows - 1);
  if (const cv::Mat& mask = maps_->mask(view); !mask.empty() && !mask.at<uint8_t>(y0, x0)) return std::nullopt;
  const float fx = static_cast<float>(x - x0), fy = static_cast<float>(y - y0);
  const auto at = [&](int row, int column) {
    const cv::Vec3w& c = map.at<cv::Vec3w>(row, column);
    return Eigen::Array3f(c[2], c[1], c[0]);
  };
  const Eigen::Array3f color =
      ((1 - fx) * ((1 - fy) * at(y0, x0) + fy * at(y1, x0)) + fx * ((1 - fy) * at(y0, x1) + fy * at(y1, x1))) /
      65535.0F;
  if (color.maxCoeff() > kCutOff) return std::nullopt;
  return color;
}

float ColorSpread(std::vector<Eigen::Array3f>& colors, size_t fewest) {
  if (colors.size() < fewest) return std::numeric_limits<float>::infinity();
  const auto middle = colors.size() / 2;
  Eigen::Array3f median;
  std::vector<float> values(colors.size());
  for (int c = 0; c < 3; ++c) {
    for (size_t i = 0; i < colors.size(); ++i) values[i] = colors[i][c];
    std::nth_element(values.begin(), values.begin() + middle, values.end());
    median[c] = values[middle];
  }
  for (size_t i = 0; i < colors.size(); ++i) values[i] = (colors[i] - median).matrix().norm();
  std::nth_element(values.begin(), values.begin() + middle, values.end());
  return values[middle];
}

}  // namespace glint
