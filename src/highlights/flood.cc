#include "highlights/flood.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "highlights/row_kernel.h"

namespace glint {
namespace {

// The bits of `inside` that are connected to `seed` without a gap (Kogge, Stone: steps of 1, 2, 4, ...).
uint64_t Spread(uint64_t seed, uint64_t inside) {
  seed &= inside;
  uint64_t up = inside, down = inside;
  for (int step = 1; step < 64; step *= 2) {
    const uint64_t grown = seed | (up & (seed << step)) | (down & (seed >> step));
    if (step == 1 && grown == seed) return seed;
    seed = grown;
    up &= up << step;
    down &= down >> step;
  }
  return seed;
}

}  // namespace

Flood::Row& Flood::At(int index) {
  Row& row = rows_[index];
  if (index >= first_ && index <= last_) return row;
  first_ = std::min(first_, index);
  last_ = std::max(last_, index);
  row = {0, 0, 0};
  const int y = corner_.y() + index;
  if (y < 0 || y >= map_->rows) return row;
  const int x0 = std::max(corner_.x(), 0), x1 = std::min(corner_.x() + kRows, map_->cols);
  const uint16_t* values = map_->ptr<uint16_t>(y);
  row.valid = ((uint64_t{1} << (x1 - x0)) - 1) << (x0 - corner_.x());
  if (corner_.x() >= 0 && corner_.x() + 64 <= map_->cols) {
    row.above = internal::BitsAbove(values + corner_.x(), threshold_) & row.valid;
  } else {
    std::array<uint16_t, 64> padded{};
    std::memcpy(padded.data() + (x0 - corner_.x()), values + x0, sizeof(uint16_t) * (x1 - x0));
    row.above = internal::BitsAbove(padded.data(), threshold_);
  }
  if (!mask_->empty()) {
    const uint8_t* in_mask = mask_->ptr<uint8_t>(y);
    for (int x = x0; x < x1; ++x)
      if (!in_mask[x]) row.valid &= ~(uint64_t{1} << (x - corner_.x()));
    row.above &= row.valid;
  }
  return row;
}

bool Flood::Flow(int from, int to) {
  Row& into = At(to);
  const uint64_t fresh = rows_[from].filled & into.above & ~into.filled;
  if (fresh == 0) return false;
  into.filled |= Spread(fresh, into.above);
  return true;
}

bool Flood::Spill() {
  constexpr uint64_t kSides = uint64_t{1} | (uint64_t{1} << (kRows - 1));
  for (bool changed = true; changed;) {
    changed = false;
    for (int r = top_; r <= bottom_; ++r) {
      if ((rows_[r].filled & kSides) != 0 || r + 1 == kRows) return false;
      if (Flow(r, r + 1)) changed = true, bottom_ = std::max(bottom_, r + 1);
    }
    for (int r = bottom_; r >= top_; --r) {
      if ((rows_[r].filled & kSides) != 0 || r == 0) return false;
      if (Flow(r, r - 1)) changed = true, top_ = std::min(top_, r - 1);
    }
    int count = 0;
    for (int r = top_; r <= bottom_; ++r) count += std::popcount(rows_[r].filled);
    if (count > kMaxPixels) return false;
  }
  return true;
}

Flood::Outcome Flood::Fill(const cv::Mat& map, const cv::Mat& mask, const Eigen::Vector2i& peak, uint16_t threshold) {
  map_ = &map, mask_ = &mask, threshold_ = threshold;
  corner_ = peak - Eigen::Vector2i(kWindow, kWindow);
  first_ = kRows, last_ = -1;
  top_ = bottom_ = kWindow;
  const uint64_t seed = uint64_t{1} << kWindow;
  Row& middle = At(kWindow);
  middle.filled = Spread(seed, middle.above | seed);
  Outcome outcome{!Spill(), false};
  for (int r = top_; r <= bottom_ && !outcome.unbounded; ++r) {
    const uint64_t filled = rows_[r].filled;
    outcome.touches_border |= (((filled << 1) | (filled >> 1)) & ~rows_[r].valid) != 0 ||
                              (filled & ~rows_[r - 1].valid) != 0 || (filled & ~rows_[r + 1].valid) != 0;
  }
  return outcome;
}

void Flood::Runs(std::vector<PixelRun>& runs) const {
  runs.clear();
  for (int r = top_; r <= bottom_; ++r)
    for (uint64_t bits = rows_[r].filled; bits != 0;) {
      const int start = std::countr_zero(bits), length = std::countr_one(bits >> start);
      runs.push_back({corner_.x() + start, corner_.y() + r, length});
      bits &= ~(((uint64_t{1} << length) - 1) << start);
    }
}

}  // namespace glint
