#include "highlights/scale_space.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace glint {
namespace {

constexpr int kWindow = 40;           // half side of the window a blob may fill at its level
constexpr double kRingRadius = 11;    // where the surroundings are sampled, level pixels
constexpr double kMaxMinorSigma = 3;  // wider ones are left to the next level

constexpr size_t kMaxPixels = 900;  // a streak as wide as kMaxMinorSigma across the window
constexpr uint16_t kWhite = 65535;

struct Peak {
  Eigen::Vector2i at;
  double value;
};

// Local maxima of smooth − wide that stand out enough.
std::vector<Peak> FindPeaks(const cv::Mat& smooth, const cv::Mat& wide, const BlobOptions& options) {
  std::vector<Peak> peaks;
  cv::Mat difference;
  cv::subtract(smooth, wide, difference);  // saturates at 0: only what is brighter counts
  const int threshold = static_cast<int>(0.4 * options.min_strength * kWhite);
  const double contrast = 0.4 * options.min_contrast;
  for (int y = 1; y + 1 < difference.rows; ++y) {
    const uint16_t* above = difference.ptr<uint16_t>(y - 1);
    const uint16_t* row = difference.ptr<uint16_t>(y);
    const uint16_t* below = difference.ptr<uint16_t>(y + 1);
    for (int x = 1; x + 1 < difference.cols; ++x) {
      const uint16_t d = row[x];
      if (d <= threshold || d <= row[x - 1] || d < row[x + 1] || d <= above[x] || d < below[x]) continue;
      if (d <= above[x - 1] || d <= above[x + 1] || d < below[x - 1] || d < below[x + 1]) continue;
      if (d <= contrast * wide.ptr<uint16_t>(y)[x]) continue;
      peaks.push_back({{x, y}, smooth.ptr<uint16_t>(y)[x] / double(kWhite)});
    }
  }
  return peaks;
}

// The level blurred over 18 × 18 of its pixels, by way of the next level.
cv::Mat Surroundings(const std::vector<cv::Mat>& pyramid, int level) {
  cv::Mat wide;
  if (level + 1 == static_cast<int>(pyramid.size())) {
    cv::blur(pyramid[level], wide, {17, 17});
    return wide;
  }
  cv::Mat half;
  cv::blur(pyramid[level + 1], half, {9, 9});
  cv::pyrUp(half, wide, pyramid[level].size());
  return wide;
}

// A low quantile of the brightness on a ring around the peak, which a streak or a bright neighbour may cross; pixels
// off the image or the mask are left out.
double BodyBrightness(const cv::Mat& map, const cv::Mat& mask, const Eigen::Vector2i& at) {
  static const auto ring = [] {
    std::array<Eigen::Vector2i, 24> offsets;
    for (size_t k = 0; k < offsets.size(); ++k) {
      const double a = 2 * M_PI * k / offsets.size();
      offsets[k] = Eigen::Vector2d(kRingRadius * std::cos(a), kRingRadius * std::sin(a)).array().round().cast<int>();
    }
    return offsets;
  }();
  std::array<uint16_t, ring.size()> samples;
  size_t n = 0;
  for (const Eigen::Vector2i& offset : ring) {
    const int x = at.x() + offset.x(), y = at.y() + offset.y();
    if (x < 0 || y < 0 || x >= map.cols || y >= map.rows) continue;
    if (!mask.empty() && !mask.ptr<uint8_t>(y)[x]) continue;
    samples[n++] = map.ptr<uint16_t>(y)[x];
  }
  if (n == 0) return 0;
  std::nth_element(samples.begin(), samples.begin() + n * 3 / 10, samples.begin() + n);
  return samples[n * 3 / 10] / double(kWhite);
}

// Scratch memory of the flood fill: one stamp a window pixel.
class Flood {
 public:
  // Everything 4-connected to blob.peak above `threshold` within the window.
  void Fill(const cv::Mat& map, const cv::Mat& mask, uint16_t threshold, Blob& blob) {
    ++stamp_;
    blob.pixels.clear();
    Push(blob, blob.peak);
    for (size_t i = 0; i < blob.pixels.size(); ++i) {
      const Eigen::Vector2i p = blob.pixels[i];
      for (const Eigen::Vector2i& step :
           {Eigen::Vector2i(1, 0), Eigen::Vector2i(-1, 0), Eigen::Vector2i(0, 1), Eigen::Vector2i(0, -1)}) {
        const Eigen::Vector2i q = p + step;
        if (q.x() < 0 || q.y() < 0 || q.x() >= map.cols || q.y() >= map.rows ||
            (!mask.empty() && !mask.ptr<uint8_t>(q.y())[q.x()])) {
          blob.touches_border = true;
          continue;
        }
        const Eigen::Vector2i offset = q - blob.peak;
        if (std::abs(offset.x()) > kWindow || std::abs(offset.y()) > kWindow || blob.pixels.size() > kMaxPixels) {
          blob.unbounded = true;
          return;
        }
        if (map.ptr<uint16_t>(q.y())[q.x()] > threshold) Push(blob, q);
      }
    }
  }

 private:
  void Push(Blob& blob, const Eigen::Vector2i& q) {
    const Eigen::Vector2i w = q - blob.peak + Eigen::Vector2i(kWindow, kWindow);
    int& s = seen_[w.y() * (2 * kWindow + 1) + w.x()];
    if (s == stamp_) return;
    s = stamp_;
    blob.pixels.push_back(q);
  }

  std::vector<int> seen_ = std::vector<int>((2 * kWindow + 1) * (2 * kWindow + 1), 0);
  int stamp_ = 0;
};

void Measure(Blob& blob) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const auto& p : blob.pixels) sum += p.cast<double>();
  blob.centroid = sum / blob.pixels.size();
  // A pixel is a square: its own second moment is 1/12.
  blob.moments = Eigen::Matrix2d::Identity() / 12;
  for (const auto& p : blob.pixels) {
    const Eigen::Vector2d d = p.cast<double>() - blob.centroid;
    blob.moments += d * d.transpose() / blob.pixels.size();
  }
}

double MinorSigma(const Blob& blob) {
  return std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(blob.moments).eigenvalues()[0]);
}

// The same blob as one found at a finer level: its peak lies in the other and the sizes agree.
bool SameBlob(const Blob& fine, const Blob& coarse) {
  const double scale = std::ldexp(1.0, coarse.level - fine.level);
  const double area_ratio = coarse.pixels.size() * scale * scale / fine.pixels.size();
  if (area_ratio > 5 || area_ratio < 0.2) return false;
  const Eigen::Vector2d d = coarse.centroid * scale - fine.centroid;
  return d.dot(fine.moments.inverse() * d) < 4;
}

}  // namespace

std::vector<cv::Mat> BrightnessPyramid(const cv::Mat& map, int min_side_px) {
  std::vector<cv::Mat> pyramid = {map};
  while (std::min(pyramid.back().rows, pyramid.back().cols) >= 2 * min_side_px) {
    cv::Mat half;
    cv::pyrDown(pyramid.back(), half);
    pyramid.push_back(half);
  }
  return pyramid;
}

std::vector<Blob> FindBlobs(const std::vector<cv::Mat>& pyramid, const std::vector<cv::Mat>& mask_pyramid,
                            const BlobOptions& options) {
  std::vector<Blob> found;
  Flood flood;
  const cv::Mat no_mask;
  const int num_levels = static_cast<int>(pyramid.size());
  // The coarsest level at which a blob of the largest size is no wider than kMaxMinorSigma.
  const int top =
      std::clamp(static_cast<int>(std::ceil(std::log2(options.max_size_px / (2 * kMaxMinorSigma)))), 0, num_levels - 1);
  for (int level = 0; level <= top; ++level) {
    cv::Mat smooth = pyramid[level];
    if (level == 0) cv::GaussianBlur(pyramid[0], smooth, {3, 3}, 0.6);
    const cv::Mat wide = Surroundings(pyramid, level);
    const cv::Mat& mask = mask_pyramid.empty() ? no_mask : mask_pyramid[level];
    const size_t num_finer = found.size();
    for (const Peak& peak : FindPeaks(smooth, wide, options)) {
      Blob blob;
      blob.level = level;
      blob.peak = peak.at;
      if (!mask.empty() && !mask.ptr<uint8_t>(peak.at.y())[peak.at.x()]) continue;
      blob.peak_value = peak.value;
      blob.body = BodyBrightness(smooth, mask, peak.at);
      const double rise = peak.value - blob.body;
      if (rise < options.min_strength || rise < options.min_contrast * blob.body) continue;
      flood.Fill(smooth, mask, static_cast<uint16_t>(kWhite * (blob.body + 0.5 * rise)), blob);
      if (blob.unbounded && level < top) continue;
      Measure(blob);
      if (level < top && MinorSigma(blob) > kMaxMinorSigma) continue;
      // Thinner than the level can resolve: found, or too faint, at a finer one.
      if (level > 0 && blob.pixels.size() < 9) continue;
      const auto same = std::find_if(found.begin(), found.end(), [&](const Blob& b) { return SameBlob(b, blob); });
      if (same == found.end()) {
        found.push_back(std::move(blob));
      } else if (static_cast<size_t>(same - found.begin()) >= num_finer && blob.peak_value > same->peak_value) {
        *same = std::move(blob);
      }
    }
  }
  return found;
}

}  // namespace glint
