// A few samples taken around something, and their order.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <opencv2/core/hal/intrin.hpp>

namespace glint {

class SamplesAround {
 public:
  static constexpr size_t kMost = 24;

  SamplesAround() { samples_.fill(UINT16_MAX); }

  void Put(uint16_t sample) { samples_[count_++] = sample; }

  size_t size() const { return count_; }

  // The sample that so many are below: the largest that no more than `rank` are less than.
  uint16_t Ranked(size_t rank) const {
    // The instruction sets that are everywhere compare only signed numbers.
    const cv::v_uint16x8 flip = cv::v_setall_u16(0x8000);
    std::array<cv::v_int16x8, kVectors> values, below;
    for (size_t v = 0; v < kVectors; ++v) {
      values[v] = cv::v_reinterpret_as_s16(cv::v_load(samples_.data() + kLanes * v) ^ flip);
      below[v] = cv::v_setzero_s16();
    }
    for (size_t k = 0; k < count_; ++k) {
      const cv::v_int16x8 sample = cv::v_setall_s16(static_cast<int16_t>(samples_[k] ^ 0x8000));
      for (size_t v = 0; v < kVectors; ++v) below[v] -= values[v] > sample;
    }
    const cv::v_int16x8 limit = cv::v_setall_s16(static_cast<int16_t>(rank));
    cv::v_int16x8 largest = cv::v_setall_s16(INT16_MIN);
    for (size_t v = 0; v < kVectors; ++v)
      largest = cv::v_max(largest, cv::v_select(below[v] > limit, cv::v_setall_s16(INT16_MIN), values[v]));
    return static_cast<uint16_t>(cv::v_reduce_max(largest) ^ 0x8000);
  }

  size_t NumAbove(uint16_t threshold) const {
    return static_cast<size_t>(std::count_if(samples_.begin(), samples_.begin() + count_,
                                             [threshold](uint16_t sample) { return sample > threshold; }));
  }

 private:
  static constexpr size_t kLanes = 8, kVectors = kMost / kLanes;

  alignas(16) std::array<uint16_t, kMost> samples_;
  size_t count_ = 0;
};

}  // namespace glint
