#include "highlights/bright_peaks.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace glint {
namespace {

constexpr double kWhite = 65535;
constexpr double kOfContrast = 0.4;  // of what a blob must rise: the surroundings here are not yet its own

// A level blurred over 18 × 18 of its pixels by way of the next level, some rows at a time.
class Surroundings {
 public:
  Surroundings(const std::vector<cv::Mat>& pyramid, int level) : size_(pyramid[level].size()) {
    is_half_ = level + 1 < static_cast<int>(pyramid.size());
    cv::blur(pyramid[is_half_ ? level + 1 : level], blurred_, is_half_ ? cv::Size(9, 9) : cv::Size(17, 17));
  }

  cv::Mat Rows(int first, int last) {
    if (!is_half_) return blurred_.rowRange(first, last);
    // What lies beyond the ends of a piece is interpolated, too.
    constexpr int kBeyond = 2;
    const int a = std::max(0, first / 2 - kBeyond), b = std::min(blurred_.rows, (last + 1) / 2 + kBeyond);
    cv::pyrUp(blurred_.rowRange(a, b), piece_, {size_.width, std::min(2 * b, size_.height) - 2 * a});
    return piece_.rowRange(first - 2 * a, last - 2 * a);
  }

 private:
  cv::Size size_;
  bool is_half_;
  cv::Mat blurred_, piece_;
};

}  // namespace

std::vector<BrightPeak> FindPeaks(const std::vector<cv::Mat>& pyramid, int level, double min_strength,
                                  double min_contrast) {
  constexpr int kBand = 48, kStride = 8;
  const auto threshold = static_cast<int>(kOfContrast * min_strength * kWhite);
  const double contrast = kOfContrast * min_contrast;
  std::vector<BrightPeak> peaks;
  const cv::Mat& smooth = pyramid[level];
  Surroundings surroundings(pyramid, level);
  cv::Mat difference, highest, is_peak;
  for (int first = 1; first + 1 < smooth.rows; first += kBand) {
    const int last = std::min(first + kBand, smooth.rows - 1);
    const cv::Mat wide = surroundings.Rows(first - 1, last + 1);
    cv::subtract(smooth.rowRange(first - 1, last + 1), wide,
                 difference);  // saturates at 0: only what is brighter counts
    cv::dilate(difference, highest, cv::Mat());
    cv::max(highest, cv::Scalar(threshold + 1), highest);
    cv::compare(difference, highest, is_peak, cv::CMP_EQ);
    for (int y = 1; y + 1 < difference.rows; ++y) {
      const uint16_t* above = difference.ptr<uint16_t>(y - 1);
      const uint16_t* row = difference.ptr<uint16_t>(y);
      const auto look = [&](int x) {
        const uint16_t d = row[x];
        // Of equal neighbours the first is the peak.
        if (d == row[x - 1] || d == above[x - 1] || d == above[x] || d == above[x + 1]) return;
        if (d <= contrast * wide.ptr<uint16_t>(y)[x]) return;
        const int at_y = first - 1 + y;
        peaks.push_back({{x, at_y}, smooth.ptr<uint16_t>(at_y)[x] / kWhite});
      };
      const uint8_t* flags = is_peak.ptr<uint8_t>(y);
      int x = 1;
      for (; x + kStride < difference.cols; x += kStride) {
        uint64_t any;
        std::memcpy(&any, flags + x, kStride);
        for (int k = 0; any != 0 && k < kStride; ++k)
          if (flags[x + k]) look(x + k);
      }
      for (; x + 1 < difference.cols; ++x)
        if (flags[x]) look(x);
    }
  }
  return peaks;
}

}  // namespace glint
