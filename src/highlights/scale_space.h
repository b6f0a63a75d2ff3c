// Bright blobs of every size: where a brightness map rises above its surroundings.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "highlights/flood.h"

namespace glint {

// Level l is the map, smoothed a little and halved l times; its pixel (x, y) is centred on pixel (x, y) << l of the
// map. The map's own memory becomes level 0.
std::vector<cv::Mat> BrightnessPyramid(cv::Mat map, int min_side_px = 12);

struct Blob {
  int level = 0;
  Eigen::Vector2i peak;         // level pixels
  double peak_value = 0;        // 1 = sensor white, smoothed at the level
  double body = 0;              // the surroundings' brightness
  std::vector<PixelRun> runs;   // above half height, connected to the peak; level pixels
  int area = 0;                 // of `runs`
  Eigen::Vector2d centroid;     // level pixels
  Eigen::Matrix2d moments;      // of `runs`, level pixels²
  bool touches_border = false;  // of the image, or of the mask
  bool unbounded = false;       // did not end within the largest size looked at
};

struct BlobOptions {
  double min_strength;  // 1 = sensor white
  double min_contrast;  // of the body
  double max_size_px;   // largest radius, map pixels
};

// Local maxima of the difference of Gaussians at every level with what is above half their height around them.
// A blob found at several levels is reported once. `mask_pyramid`: empty or one CV_8U map a level, 0 is ignored.
std::vector<Blob> FindBlobs(const std::vector<cv::Mat>& pyramid, const std::vector<cv::Mat>& mask_pyramid,
                            const BlobOptions& options);

}  // namespace glint
