// Linear brightness maps of images, shared by detection and the gate.
#pragma once

#include <array>
#include <cstdint>
#include <opencv2/core/mat.hpp>

namespace glint {

// Linear value of an sRGB encoded channel, code in [0, 1].
double LinearFromSrgb(double code);

// Linear minimum over the channels, CV_16UC1, 65535 = sensor white. Accepts 1, 3 or 4 channels of 8 or 16 bits.
cv::Mat LinearMinChannel(const cv::Mat& image);

// Linear colours, CV_16UC3, BGR, 65535 = sensor white; of the same images.
cv::Mat LinearColors(const cv::Mat& image);

// Linear colour (BGR, 1 = sensor white) of one pixel of such an image.
std::array<float, 3> LinearColor(const cv::Mat& image, int x, int y);

}  // namespace glint
