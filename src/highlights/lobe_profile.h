// How a highlight falls off tells an extended lamp on smooth gloss from a small one on rough gloss.
#pragma once

#include <opencv2/core/mat.hpp>

#include "highlights/scale_space.h"

namespace glint {

// Area above 80 % of the blob's rise over its area above half of it: 0.28 of a GGX lobe whatever its roughness, towards
// 1 of the sharp image of a disc. 0: too few pixels, or too many saturated ones, to tell. `map`: the blob's level.
double Flatness(const cv::Mat& map, const Blob& blob, double saturation);

// Radius of a disc that a GGX lobe of any width smears to this flatness, in units of the blob's radius at half height;
// 0 for what is no flatter than the lobe alone.
double DiscShare(double flatness);

}  // namespace glint
