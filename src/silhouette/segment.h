// One photograph into object and surroundings. Only for .cc files of this module: it brings OpenCV along.
#pragma once

#include <opencv2/core.hpp>

namespace glint::internal {

struct SegmentInput {
  cv::Mat image;     // CV_8UC3
  cv::Mat prior;     // CV_32F: signed distance from the outline as it is expected, px, negative inside
  cv::Mat hints;     // CV_8S: 1 the object, -1 not, 0 unknown
  double reach = 0;  // px outside of the expected outline in which the object may be
  double core = 0;   // px inside of it from where on it is the object for sure
  cv::Mat near;      // CV_8U: non-zero where that is so even if what is expected spans holes
};

struct Segmentation {
  cv::Mat object;   // CV_8U, 255 on it; with all of the core
  cv::Mat through;  // CV_8U, 255 where the core looks like the surroundings instead
};

// Deterministic.
Segmentation Segment(const SegmentInput& input);

}  // namespace glint::internal
