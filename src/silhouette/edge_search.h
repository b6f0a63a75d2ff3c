// Outlines moved onto the edges of the photograph. Only for .cc files of this module: it brings OpenCV along.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "silhouette/view_mask.h"

namespace glint::internal {

// The points moved along their direction onto the strongest edge near them, to a fraction of a px; those that have
// none left out. `image`: CV_8UC3 of the raster.
std::vector<ContourPoint> OnEdges(const cv::Mat& image, const std::vector<ContourPoint>& contour);

}  // namespace glint::internal
