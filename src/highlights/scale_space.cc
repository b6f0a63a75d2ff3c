#include "highlights/scale_space.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "highlights/flood.h"

namespace glint {
namespace {

constexpr double kRingRadius = 11;    // where the surroundings are sampled, level pixels
constexpr double kMaxMinorSigma = 3;  // wider ones are left to the next level
constexpr uint16_t kWhite = 65535;

struct Peak {
  Eigen::Vector2i at;
  double value;
};

// Weights of a Gaussian of 0.6 pixels, in 256ths.
cv::Mat SmoothedLittle(const cv::Mat& map) {
  constexpr uint32_t kSide = 43, kMiddle = 170;
  cv::Mat smooth(map.size(), CV_16UC1);
  std::vector<uint16_t> column(map.cols + 2);
  for (int y = 0; y < map.rows; ++y) {
    const uint16_t* above = map.ptr<uint16_t>(std::max(y - 1, 0));
    const uint16_t* row = map.ptr<uint16_t>(y);
    const uint16_t* below = map.ptr<uint16_t>(std::min(y + 1, map.rows - 1));
    uint16_t* sum = column.data() + 1;
    for (int x = 0; x < map.cols; ++x)
      sum[x] = static_cast<uint16_t>((kMiddle * row[x] + kSide * (uint32_t{above[x]} + below[x]) + 128) >> 8);
    sum[-1] = sum[0], sum[map.cols] = sum[map.cols - 1];
    uint16_t* out = smooth.ptr<uint16_t>(y);
    for (int x = 0; x < map.cols; ++x)
      out[x] = static_cast<uint16_t>((kMiddle * sum[x] + kSide * (uint32_t{sum[x - 1]} + sum[x + 1]) + 128) >> 8);
  }
  return smooth;
}

// Local maxima of smooth − wide that stand out enough.
std::vector<Peak> FindPeaks(const cv::Mat& smooth, const cv::Mat& wide, const BlobOptions& options) {
  std::vector<Peak> peaks;
  cv::Mat difference;
  cv::subtract(smooth, wide, difference);  // saturates at 0: only what is brighter counts
  const auto threshold = static_cast<int>(0.4 * options.min_strength * kWhite);
  const double contrast = 0.4 * options.min_contrast;
  cv::Mat highest, is_peak;
  cv::dilate(difference, highest, cv::Mat());
  cv::max(highest, cv::Scalar(threshold + 1), highest);
  cv::compare(difference, highest, is_peak, cv::CMP_EQ);
  constexpr int kStride = 8;
  for (int y = 1; y + 1 < difference.rows; ++y) {
    const uint16_t* above = difference.ptr<uint16_t>(y - 1);
    const uint16_t* row = difference.ptr<uint16_t>(y);
    const auto look = [&](int x) {
      const uint16_t d = row[x];
      // Of equal neighbours the first is the peak.
      if (d == row[x - 1] || d == above[x - 1] || d == above[x] || d == above[x + 1]) return;
      if (d <= contrast * wide.ptr<uint16_t>(y)[x]) return;
      peaks.push_back({{x, y}, smooth.ptr<uint16_t>(y)[x] / double(kWhite)});
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
  explicit Found(const cv::Size& size)
      : columns_(size.width / kCell + 1), rows_(size.height / kCell + 1), newest_(size_t(columns_) * rows_, -1) {}

  // Index of the first blob that is the same; size(): none.
  size_t Same(const Blob& blob) const {
    const Eigen::Vector2i cell = CellAt(blob.centroid * std::ldexp(1.0, blob.level));
    size_t first = blobs_.size();
    for (int e = newest_[size_t(cell.y()) * columns_ + cell.x()]; e >= 0; e = entries_[e].older)
      if (entries_[e].blob < first && SameBlob(blobs_[entries_[e].blob], blob)) first = entries_[e].blob;
    return first;
  }

  void Put(size_t index, const Blob& blob) {
    if (index == blobs_.size())
      blobs_.push_back(blob);
    else
      blobs_[index] = blob;
    // Into every cell in which a centroid of the same blob may lie.
    const double scale = std::ldexp(1.0, blob.level);
    const Eigen::Vector2d reach = 2 * scale * blob.moments.diagonal().cwiseSqrt();
    const Eigen::Vector2i low = CellAt(scale * blob.centroid - reach), high = CellAt(scale * blob.centroid + reach);
    for (int y = low.y(); y <= high.y(); ++y)
      for (int x = low.x(); x <= high.x(); ++x) {
        int& newest = newest_[size_t(y) * columns_ + x];
        entries_.push_back({index, newest});
        newest = static_cast<int>(entries_.size()) - 1;
      }
  }

  size_t size() const { return blobs_.size(); }
  const Blob& operator[](size_t index) const { return blobs_[index]; }
  std::vector<Blob> Take() { return std::move(blobs_); }

 private:
  static constexpr int kCell = 32;
  struct Entry {
    size_t blob;
    int older;  // of the same cell
  };

  Eigen::Vector2i CellAt(const Eigen::Vector2d& px) const {
    return {std::clamp(static_cast<int>(px.x()) / kCell, 0, columns_ - 1),
            std::clamp(static_cast<int>(px.y()) / kCell, 0, rows_ - 1)};
  }

  int columns_, rows_;
  std::vector<int> newest_;
  std::vector<Entry> entries_;
  std::vector<Blob> blobs_;
};

}  // namespace

std::vector<cv::Mat> BrightnessPyramid(const cv::Mat& map, int min_side_px) {
  std::vector<cv::Mat> pyramid = {map};
  while (std::min(pyramid.back().rows, pyramid.back().cols) >= 2 * min_side_px) {
    cv::Mat half;
    cv::pyrDown(pyramid.back(), half);
    pyramid.push_back(half);
  }
  // The other levels are smoothed by what halved them.
  pyramid[0] = SmoothedLittle(map);
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
    const cv::Mat wide = Surroundings(pyramid, level);
    const cv::Mat& mask = mask_pyramid.empty() ? no_mask : mask_pyramid[level];
    const size_t num_finer = found.size();
    for (const Peak& peak : FindPeaks(smooth, wide, options)) {
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
      if (same == found.size() || (same >= num_finer && blob.peak_value > found[same].peak_value)) found.Put(same, blob);
    }
  }
  return found.Take();
}

}  // namespace glint
