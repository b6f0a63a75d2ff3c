#include "highlights/scale_space.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "core/cancel_scope.h"
#include "highlights/bright_peaks.h"
#include "highlights/flood.h"
#include "highlights/place_index.h"

namespace glint {
namespace {

constexpr double kRingRadius = 11;    // where the surroundings are sampled, level pixels
constexpr double kMaxMinorSigma = 3;  // wider ones are left to the next level
constexpr uint16_t kWhite = 65535;

// In place, by a Gaussian of 0.6 pixels; weights in 256ths.
void SmoothLittle(cv::Mat& map) {
  constexpr uint32_t kSide = 43, kMiddle = 170;
  std::vector<uint16_t> above(map.ptr<uint16_t>(0), map.ptr<uint16_t>(0) + map.cols), own, column(map.cols + 2);
  for (int y = 0; y < map.rows; ++y) {
    uint16_t* row = map.ptr<uint16_t>(y);
    const uint16_t* below = map.ptr<uint16_t>(std::min(y + 1, map.rows - 1));
    own.assign(row, row + map.cols);
    uint16_t* sum = column.data() + 1;
    for (int x = 0; x < map.cols; ++x)
      sum[x] = static_cast<uint16_t>((kMiddle * own[x] + kSide * (uint32_t{above[x]} + below[x]) + 128) >> 8);
    sum[-1] = sum[0], sum[map.cols] = sum[map.cols - 1];
    for (int x = 0; x < map.cols; ++x)
      row[x] = static_cast<uint16_t>((kMiddle * sum[x] + kSide * (uint32_t{sum[x - 1]} + sum[x + 1]) + 128) >> 8);
    above.swap(own);
  }
}

// The brightness on a ring around a peak, without pixels off the image or the mask.
class Ring {
 public:
  Ring(const cv::Mat& map, const cv::Mat& mask, const Eigen::Vector2i& at) {
    for (const Eigen::Vector2i& offset : Offsets()) {
      const int x = at.x() + offset.x(), y = at.y() + offset.y();
      if (x < 0 || y < 0 || x >= map.cols || y >= map.rows) continue;
      if (!mask.empty() && !mask.ptr<uint8_t>(y)[x]) continue;
      samples_[count_++] = map.ptr<uint16_t>(y)[x];
    }
  }

  // A low quantile: a streak or a bright neighbour may cross the ring.
  double Body() {
    if (count_ == 0) return 0;
    std::nth_element(samples_.begin(), samples_.begin() + count_ * 3 / 10, samples_.begin() + count_);
    return samples_[count_ * 3 / 10] / double(kWhite);
  }

  // More of the ring than is covered by any blob that is not left to the next level: a streak of kMaxMinorSigma covers
  // 0.31 of it.
  bool ManyAbove(uint16_t threshold) const {
    const auto above = std::count_if(samples_.begin(), samples_.begin() + count_,
                                     [threshold](uint16_t sample) { return sample > threshold; });
    return static_cast<double>(above) > 0.5 * static_cast<double>(count_);
  }

 private:
  static constexpr size_t kSamples = 24;

  static const std::array<Eigen::Vector2i, kSamples>& Offsets() {
    static const auto ring = [] {
      std::array<Eigen::Vector2i, kSamples> offsets;
      for (size_t k = 0; k < kSamples; ++k) {
        const double a = 2 * M_PI * k / kSamples;
        offsets[k] = Eigen::Vector2d(kRingRadius * std::cos(a), kRingRadius * std::sin(a)).array().round().cast<int>();
      }
      return offsets;
    }();
    return ring;
  }

  std::array<uint16_t, kSamples> samples_;
  size_t count_ = 0;
};

void Measure(Blob& blob) {
  int64_t x = 0, y = 0, xx = 0, xy = 0, yy = 0;  // about the peak
  for (const auto& p : blob.pixels) {
    const int dx = p.x() - blob.peak.x(), dy = p.y() - blob.peak.y();
    x += dx, y += dy, xx += dx * dx, xy += dx * dy, yy += dy * dy;
  }
  const double n = static_cast<double>(blob.pixels.size());
  const Eigen::Vector2d mean(x / n, y / n);
  blob.centroid = blob.peak.cast<double>() + mean;
  blob.moments << xx / n, xy / n, xy / n, yy / n;
  blob.moments -= mean * mean.transpose();
  // A pixel is a square: its own second moment is 1/12.
  blob.moments.diagonal().array() += 1 / 12.0;
}

double MinorSigma(const Blob& blob) {
  const double middle = 0.5 * blob.moments.trace();
  return std::sqrt(std::max(0.0, middle - std::sqrt(std::max(0.0, middle * middle - blob.moments.determinant()))));
}

// The same blob as one found at a finer level: its peak lies in the other and the sizes agree.
bool SameBlob(const Blob& fine, const Blob& coarse) {
  const double scale = std::ldexp(1.0, coarse.level - fine.level);
  const double area_ratio = coarse.pixels.size() * scale * scale / fine.pixels.size();
  if (area_ratio > 5 || area_ratio < 0.2) return false;
  const Eigen::Vector2d d = coarse.centroid * scale - fine.centroid;
  return d.dot(fine.moments.inverse() * d) < 4;
}

// What was found, by place.
class Found {
 public:
  explicit Found(const cv::Size& size) : places_(size.width, size.height) {}

  // Index of the first blob that is the same; size(): none.
  size_t Same(const Blob& blob) const {
    size_t first = blobs_.size();
    places_.At(blob.centroid * std::ldexp(1.0, blob.level), [&](size_t k) {
      if (k < first && SameBlob(blobs_[k], blob)) first = k;
    });
    return first;
  }

  void Put(size_t index, const Blob& blob) {
    if (index == blobs_.size())
      blobs_.push_back(blob);
    else
      blobs_[index] = blob;
    const double scale = std::ldexp(1.0, blob.level);
    places_.Put(index, scale * blob.centroid, 2 * scale * blob.moments.diagonal().cwiseSqrt());
  }

  size_t size() const { return blobs_.size(); }
  const Blob& operator[](size_t index) const { return blobs_[index]; }
  std::vector<Blob> Take() { return std::move(blobs_); }

 private:
  PlaceIndex places_;
  std::vector<Blob> blobs_;
};

}  // namespace

std::vector<cv::Mat> BrightnessPyramid(cv::Mat map, int min_side_px) {
  std::vector<cv::Mat> pyramid = {std::move(map)};
  while (std::min(pyramid.back().rows, pyramid.back().cols) >= 2 * min_side_px) {
    cv::Mat half;
    cv::pyrDown(pyramid.back(), half);
    pyramid.push_back(half);
  }
  // The other levels are smoothed by what halved them.
  SmoothLittle(pyramid[0]);
  return pyramid;
}

std::vector<Blob> FindBlobs(const std::vector<cv::Mat>& pyramid, const std::vector<cv::Mat>& mask_pyramid,
                            const BlobOptions& options) {
  Found found(pyramid[0].size());
  Flood flood;
  const cv::Mat no_mask;
  const int num_levels = static_cast<int>(pyramid.size());
  // The coarsest level at which a blob of the largest size is no wider than kMaxMinorSigma.
  const int top =
      std::clamp(static_cast<int>(std::ceil(std::log2(options.max_size_px / (2 * kMaxMinorSigma)))), 0, num_levels - 1);
  Blob blob;
  for (int level = 0; level <= top; ++level) {
    const cv::Mat& smooth = pyramid[level];
    const cv::Mat& mask = mask_pyramid.empty() ? no_mask : mask_pyramid[level];
    const size_t num_finer = found.size();
    for (const BrightPeak& peak : FindPeaks(pyramid, level, options.min_strength, options.min_contrast)) {
      CancelScope::Current().ThrowIfCancelled();
      if (!mask.empty() && !mask.ptr<uint8_t>(peak.at.y())[peak.at.x()]) continue;
      Ring ring(smooth, mask, peak.at);
      blob.level = level;
      blob.peak = peak.at;
      blob.peak_value = peak.value;
      blob.body = ring.Body();
      const double rise = peak.value - blob.body;
      if (rise < options.min_strength || rise < options.min_contrast * blob.body) continue;
      const auto half_height = static_cast<uint16_t>(kWhite * (blob.body + 0.5 * rise));
      if (level < top && ring.ManyAbove(half_height)) continue;
      const Flood::Outcome outcome = flood.Fill(smooth, mask, blob.peak, half_height, blob.pixels);
      blob.unbounded = outcome.unbounded;
      blob.touches_border = outcome.touches_border;
      if (blob.unbounded && level < top) continue;
      Measure(blob);
      if (level < top && MinorSigma(blob) > kMaxMinorSigma) continue;
      // Thinner than the level can resolve: found, or too faint, at a finer one.
      if (level > 0 && blob.pixels.size() < 9) continue;
      const size_t same = found.Same(blob);
      if (same == found.size() || (same >= num_finer && blob.peak_value > found[same].peak_value))
        found.Put(same, blob);
    }
  }
  return found.Take();
}

}  // namespace glint
