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
#include "highlights/place_index.h"
#include "highlights/row_kernel.h"
#include "highlights/samples_around.h"

namespace glint {
namespace {

constexpr double kRingRadius = 11;    // where the surroundings are sampled, level pixels
constexpr double kMaxMinorSigma = 3;  // wider ones are left to the next level
constexpr uint16_t kWhite = 65535;

// In place, by a Gaussian of 0.6 pixels.
void SmoothLittle(cv::Mat& map) {
  std::vector<uint16_t> above(map.ptr<uint16_t>(0), map.ptr<uint16_t>(0) + map.cols), own, column(map.cols + 2);
  for (int y = 0; y < map.rows; ++y) {
    uint16_t* row = map.ptr<uint16_t>(y);
    const uint16_t* below = map.ptr<uint16_t>(std::min(y + 1, map.rows - 1));
    own.assign(row, row + map.cols);
    uint16_t* sum = column.data() + 1;
    internal::SmoothRow(above.data(), own.data(), below, map.cols, sum);
    sum[-1] = sum[0], sum[map.cols] = sum[map.cols - 1];
    internal::SmoothRow(sum - 1, sum, sum + 1, map.cols, row);
    above.swap(own);
  }
}

// The brightness on rings around peaks, without pixels off the image or the mask.
class Rings {
 public:
  Rings(const cv::Mat& map, const cv::Mat& mask) : map_(map), mask_(mask) {
    for (size_t k = 0; k < SamplesAround::kMost; ++k) {
      const double a = 2 * M_PI * static_cast<double>(k) / SamplesAround::kMost;
      offsets_[k] = Eigen::Vector2d(kRingRadius * std::cos(a), kRingRadius * std::sin(a)).array().round().cast<int>();
      steps_[k] = offsets_[k].y() * static_cast<ptrdiff_t>(map.step1()) + offsets_[k].x();
    }
  }

  SamplesAround At(const Eigen::Vector2i& px) const {
    SamplesAround samples;
    constexpr int kFar = static_cast<int>(kRingRadius);
    if (mask_.empty() && (px.array() >= kFar).all() && px.x() + kFar < map_.cols && px.y() + kFar < map_.rows) {
      const uint16_t* middle = map_.ptr<uint16_t>(px.y()) + px.x();
      for (const ptrdiff_t step : steps_) samples.Put(middle[step]);
      return samples;
    }
    for (const Eigen::Vector2i& offset : offsets_) {
      const int x = px.x() + offset.x(), y = px.y() + offset.y();
      if (x < 0 || y < 0 || x >= map_.cols || y >= map_.rows) continue;
      if (mask_.empty() || mask_.ptr<uint8_t>(y)[x]) samples.Put(map_.ptr<uint16_t>(y)[x]);
    }
    return samples;
  }

 private:
  const cv::Mat &map_, &mask_;
  std::array<Eigen::Vector2i, SamplesAround::kMost> offsets_;
  std::array<ptrdiff_t, SamplesAround::kMost> steps_;
};

// A low quantile: a streak or a bright neighbour may cross the ring.
double Body(const SamplesAround& ring) {
  return ring.size() == 0 ? 0 : ring.Ranked(ring.size() * 3 / 10) / double(kWhite);
}

// More of the ring than is covered by any blob that is not left to the next level (a streak of kMaxMinorSigma covers
// 0.31 of it) and a little of another.
bool ManyAbove(const SamplesAround& ring, uint16_t threshold) { return 5 * ring.NumAbove(threshold) > 2 * ring.size(); }

void Measure(Blob& blob) {
  int64_t n = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;  // about the peak
  for (const PixelRun& run : blob.runs) {
    const int64_t m = run.length, a = run.x - blob.peak.x(), dy = run.y - blob.peak.y();
    const int64_t steps = m * (m - 1) / 2, run_x = m * a + steps;
    n += m, x += run_x, y += m * dy;
    xx += a * (run_x + steps) + steps * (2 * m - 1) / 3, xy += run_x * dy, yy += m * dy * dy;
  }
  blob.area = static_cast<int>(n);
  const double weight = 1 / static_cast<double>(n);
  const Eigen::Vector2d mean(weight * x, weight * y);
  blob.centroid = blob.peak.cast<double>() + mean;
  blob.moments << weight * xx, weight * xy, weight * xy, weight * yy;
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
  const double area_ratio = coarse.area * scale * scale / fine.area;
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
    const Rings rings(smooth, mask);
    for (const BrightPeak& peak : FindPeaks(pyramid, level, options.min_strength, options.min_contrast)) {
      CancelScope::Current().ThrowIfCancelled();
      if (!mask.empty() && !mask.ptr<uint8_t>(peak.at.y())[peak.at.x()]) continue;
      blob.level = level;
      blob.peak = peak.at;
      blob.peak_value = peak.value;
      const SamplesAround ring = rings.At(peak.at);
      blob.body = Body(ring);
      const double rise = peak.value - blob.body;
      if (rise < options.min_strength || rise < options.min_contrast * blob.body) continue;
      const auto half_height = static_cast<uint16_t>(kWhite * (blob.body + 0.5 * rise));
      if (level < top && ManyAbove(ring, half_height)) continue;
      const Flood::Outcome outcome = flood.Fill(smooth, mask, blob.peak, half_height);
      blob.unbounded = outcome.unbounded;
      blob.touches_border = outcome.touches_border;
      if (blob.unbounded && level < top) continue;
      flood.Runs(blob.runs);
      Measure(blob);
      if (level < top && MinorSigma(blob) > kMaxMinorSigma) continue;
      // Thinner than the level can resolve: found, or too faint, at a finer one.
      if (level > 0 && blob.area < 9) continue;
      const size_t same = found.Same(blob);
      if (same == found.size() || (same >= num_finer && blob.peak_value > found[same].peak_value))
        found.Put(same, blob);
    }
  }
  return found.Take();
}

}  // namespace glint
