// One photograph of a stage, and what is true in it.
#pragma once

#include <cstdint>
#include <vector>

#include "synthetic/stage.h"
#include "synthetic/true_highlights.h"

namespace cv {
class Mat;
}

namespace glint {

// Row by row, one entry a pixel (at its centre).
struct ViewTruth {
  int width = 0, height = 0;
  std::vector<uint8_t> object_mask;       // 255 on the object, else 0
  std::vector<float> specular;            // radiance of the lights' lobes on the object, shadowed; 1 is sensor white
  std::vector<TrueHighlight> highlights;  // in the frame that they were asked for
};

struct SensorOptions {
  double noise_levels = 0;  // standard deviation in 8-bit levels, after the tone curve
};

// The camera's response: sRGB's tone curve in 8-bit levels, continued above white (where an image is cut at 255).
double SensorLevel(double radiance);

// Sphere-traced at pixel centres, then four more rays where neighbours differ. CV_8UC3, BGR, sRGB tone curve. The
// highlights of `truth` are in the stage's frame. Parallel over rows; the same at any number of threads.
void RenderView(const Stage& stage, size_t view, const SensorOptions& sensor, cv::Mat& image, ViewTruth& truth);

}  // namespace glint
