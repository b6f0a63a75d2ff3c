// The colour of the light that a blob adds to its surroundings.
#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>

#include "highlights/scale_space.h"

namespace glint {

// Angle in degrees, in linear RGB, between the colour that brightens the blob's unsaturated flank and the nearest
// mixture of white (a dielectric's highlight) and the surroundings' own colour (a metal's). Dichromatic model, Shafer
// 1985. nullopt: a grey image, or too few unsaturated pixels to tell.
std::optional<double> TintDegrees(const cv::Mat& image_bgr, const Blob& blob, double saturation);

}  // namespace glint
