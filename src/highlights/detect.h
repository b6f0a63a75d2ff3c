// Specular highlights in one image: blobs, lobes and streaks that add light of the lamp's colour to the body's.
#pragma once

#include <cstdint>
#include <vector>

#include "core/options.h"
#include "highlights/highlight.h"

namespace cv {
class Mat;
}

namespace glint {

struct DetectOptions {
  double min_strength = 0.04;  // fraction of sensor white
  double min_contrast = 0.2;   // of the local body's brightness
  double max_size_rel = 0.25;  // fraction of the image's diagonal
  double max_tint_deg = 24;    // degrees in linear RGB
  double max_profile_error = 0.11;
  double saturation = 0.93;  // fraction of sensor white
  double position_floor_px = 0.05;

  void Visit(OptionVisitor& v);
};

// `image_bgr`: CV_8UC3 or CV_16UC3 (or one channel), sRGB encoded. `mask`: CV_8UC1 of the image's size or empty;
// 0 is ignored. Returns the candidates sorted by falling strength (ties: by row, column); those that one image
// can already tell are no highlights carry the reason in `status`. All else (surface, light, paint that stays put)
// is for GateHighlights().
//
// The brightness that counts is the linear minimum over the channels, which a coloured body keeps low and light of
// the lamp's colour raises (the intensity ratio of Shen, Zheng 2013 rests on the same minimum). Peaks are fitted
// with a GGX lobe on the flank, pixels at saturation only bound it from below.
std::vector<Highlight> DetectHighlights(const cv::Mat& image_bgr, const cv::Mat& mask, uint32_t view,
                                        const DetectOptions& options);

}  // namespace glint
