#include "highlights/bright_peaks.h"

#include <algorithm>
#include <cstdint>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "highlights/row_kernel.h"

namespace glint {
namespace {

constexpr double kWhite = 65535;
constexpr double kOfContrast = 0.4;  // of what a blob must rise: the surroundings here are not yet its own

// A level blurred over 18 × 18 of its pixels by way of the next level.
class Surroundings {
 public:
  Surroundings(const std::vector<cv::Mat>& pyramid, int level) : width_(pyramid[level].cols) {
    is_half_ = level + 1 < static_cast<int>(pyramid.size());
    cv::blur(pyramid[is_half_ ? level + 1 : level], blurred_, is_half_ ? cv::Size(9, 9) : cv::Size(17, 17));
    half_.resize(static_cast<size_t>(blurred_.cols) + 1);
  }

  void Row(int y, uint16_t* out) {
    if (!is_half_) {
      std::copy_n(blurred_.ptr<uint16_t>(y), width_, out);
      return;
    }
    const uint16_t* above = blurred_.ptr<uint16_t>(y / 2);
    const uint16_t* below = blurred_.ptr<uint16_t>(std::min((y + 1) / 2, blurred_.rows - 1));
    for (int x = 0; x < blurred_.cols; ++x) half_[x] = Middle(above[x], below[x]);
    half_[blurred_.cols] = half_[blurred_.cols - 1];
    for (ptrdiff_t x = 0; x < width_ / 2; ++x) out[2 * x] = half_[x], out[2 * x + 1] = Middle(half_[x], half_[x + 1]);
    if (width_ % 2 == 1) out[width_ - 1] = half_[width_ / 2];
  }

 private:
  static uint16_t Middle(uint16_t a, uint16_t b) { return static_cast<uint16_t>((a + b + 1) / 2); }

  int width_;
  bool is_half_;
  cv::Mat blurred_;
  std::vector<uint16_t> half_;
};

}  // namespace

std::vector<BrightPeak> FindPeaks(const std::vector<cv::Mat>& pyramid, int level, double min_strength,
                                  double min_contrast) {
  const auto threshold = static_cast<uint16_t>(std::min(kOfContrast * min_strength * kWhite, kWhite));
  const double contrast = kOfContrast * min_contrast;
  const cv::Mat& smooth = pyramid[level];
  Surroundings surroundings(pyramid, level);
  // Row y of the surroundings, and of what is brighter, is in the buffers' row y modulo 4.
  cv::Mat wide(4, smooth.cols + 64, CV_16UC1), brighter(4, smooth.cols + 64, CV_16UC1, cv::Scalar(0));
  std::vector<int> columns(smooth.cols);
  std::vector<BrightPeak> peaks;
  for (int y = 0; y < smooth.rows; ++y) {
    surroundings.Row(y, wide.ptr<uint16_t>(y % 4));
    internal::SubtractRow(smooth.ptr<uint16_t>(y), wide.ptr<uint16_t>(y % 4), smooth.cols,
                          brighter.ptr<uint16_t>(y % 4));
    if (y < 2) continue;
    const uint16_t* row = brighter.ptr<uint16_t>((y - 1) % 4);
    const size_t num = internal::RowMaxima(brighter.ptr<uint16_t>((y - 2) % 4), row, brighter.ptr<uint16_t>(y % 4),
                                           smooth.cols, threshold, columns.data());
    for (size_t k = 0; k < num; ++k) {
      const int x = columns[k];
      if (row[x] <= contrast * wide.ptr<uint16_t>((y - 1) % 4)[x]) continue;
      peaks.push_back({{x, y - 1}, smooth.ptr<uint16_t>(y - 1)[x] / kWhite});
    }
  }
  return peaks;
}

}  // namespace glint
