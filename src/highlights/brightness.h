// Linear brightness maps of images, shared by detection and the gate.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <opencv2/core/mat.hpp>

namespace glint {

// Linear value of an sRGB encoded channel, code in [0, 1].
double LinearFromSrgb(double code);

// Linear minimum over the channels, CV_16UC1, 65535 = sensor white. Accepts 1, 3 or 4 channels of 8 or 16 bits.
cv::Mat LinearMinChannel(const cv::Mat& image);

// Linear colours, CV_16UC3, BGR, 65535 = sensor white; of the same images.
cv::Mat LinearColors(const cv::Mat& image);

// Linear colours (BGR, 65535 = sensor white) of single pixels of such an image, which must outlive it.
class LinearColorReader {
 public:
  explicit LinearColorReader(const cv::Mat& image);

  std::array<uint16_t, 3> operator()(int x, int y) const {
    const std::ptrdiff_t offset = std::ptrdiff_t{x} * channels_;
    return is_8_bit_ ? Read(image_.ptr<uint8_t>(y) + offset) : Read(image_.ptr<uint16_t>(y) + offset);
  }

 private:
  template <class T>
  std::array<uint16_t, 3> Read(const T* pixel) const {
    return {table_[pixel[0]], table_[pixel[green_]], table_[pixel[red_]]};
  }

  const cv::Mat& image_;
  const uint16_t* table_;
  int channels_, green_, red_;
  bool is_8_bit_;
};

}  // namespace glint
