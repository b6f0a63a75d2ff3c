// Where one level of a brightness pyramid is brighter than all around.
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <vector>

namespace glint {

struct BrightPeak {
  Eigen::Vector2i at;  // level pixels
  double value;        // 1 = sensor white
};

// Local maxima of the level less its surroundings (18 x 18 pixels) that may belong to a blob of the least strength and
// contrast. Row by row: what is worked out stays in the cache.
std::vector<BrightPeak> FindPeaks(const std::vector<cv::Mat>& pyramid, int level, double min_strength,
                                  double min_contrast);

}  // namespace glint
