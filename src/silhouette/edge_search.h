// Outlines moved onto the edges of the photograph. Only for .cc files of this module: it brings OpenCV along.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "silhouette/view_mask.h"

namespace glint::internal {

// The points moved along their direction onto the strongest edge near them, to a fraction of a px; those that have
// none left out. `image`: CV_8UC3 of the raster.
std::vector<ContourPoint> OnEdges(const cv::Mat& image, const std::vector<ContourPoint>& contour);

// The same for points that are near the raster's edges, in the photograph, or mask, that it is a smaller picture of:
// CV_8UC3. The raster's edges are up to one of its px off, to the darker side, as it mixes colours across them; and the
// rim of a glossy object in a photograph ends outside of where it looks most different from what it mirrors.
std::vector<ContourPoint> OnFineEdges(const cv::Mat& image, const Raster& raster, bool photograph,
                                      std::vector<ContourPoint> contour);

// Standard deviation of what OnFineEdges finds, px of the raster.
double FineEdgeSigma(const Raster& raster);

}  // namespace glint::internal
