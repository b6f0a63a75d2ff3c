// Pictures of what was found.
#pragma once

#include <vector>

#include "highlights/highlight.h"

namespace cv {
class Mat;
}

namespace glint {

// A copy of the image (8-bit BGR) with an ellipse (two standard deviations of the blob) and a cross at the peak of
// each highlight: accepted ones green with the number of their light, amber while they are candidates that no light is
// known for, rejected ones red with the first letters of the reason. `highlights` are those of this view.
cv::Mat DrawHighlights(const cv::Mat& image_bgr, const std::vector<Highlight>& highlights);

// A mask in COLMAP's sense (CV_8UC1, 0 is masked out): black ellipses over the highlights that count (accepted, and
// those that were rejected for their geometry alone), grown by `margin_px`.
cv::Mat HighlightMask(int width, int height, const std::vector<Highlight>& highlights, double margin_px = 2);

}  // namespace glint
