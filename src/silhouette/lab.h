// Colours as far apart as they look. Only for .cc files of this module: it brings OpenCV along.
#pragma once

#include <opencv2/core.hpp>

namespace glint::internal {

// CV_8UC3 (blue, green, red) to CV_32FC3 in CIE L*a*b*. Any number of threads may call it.
cv::Mat ToLab(const cv::Mat& image);

}  // namespace glint::internal
