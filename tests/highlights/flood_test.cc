#include "highlights/flood.h"

#include <gtest/gtest.h>

#include <deque>
#include <opencv2/core.hpp>
#include <set>
#include <utility>

namespace glint {
namespace {

using Pixels = std::set<std::pair<int, int>>;

struct Plain {
  Pixels pixels;
  bool unbounded = false, touches_border = false;
};

// Pixel by pixel.
Plain FillPlainly(const cv::Mat& map, const cv::Mat& mask, const Eigen::Vector2i& peak, uint16_t threshold) {
  Plain out;
  out.pixels.insert({peak.x(), peak.y()});
  std::deque<std::pair<int, int>> open(out.pixels.begin(), out.pixels.end());
  while (!open.empty()) {
    const auto [x, y] = open.front();
    open.pop_front();
    out.unbounded |= std::abs(x - peak.x()) >= Flood::kWindow || std::abs(y - peak.y()) >= Flood::kWindow;
    for (const auto& [dx, dy] : {std::pair(1, 0), {-1, 0}, {0, 1}, {0, -1}}) {
      const int u = x + dx, v = y + dy;
      if (u < 0 || v < 0 || u >= map.cols || v >= map.rows || (!mask.empty() && !mask.at<uint8_t>(v, u)))
        out.touches_border = true;
      else if (map.at<uint16_t>(v, u) > threshold && out.pixels.insert({u, v}).second)
        open.push_back({u, v});
    }
  }
  out.unbounded |= out.pixels.size() > Flood::kMaxPixels;
  return out;
}

TEST(Flood, IsThatOfOnePixelAfterAnother) {
  cv::RNG random(3);
  Flood flood;
  int bounded = 0, unbounded = 0;
  for (int round = 0; round < 1500; ++round) {
    cv::Mat map(20 + random.uniform(0, 90), 20 + random.uniform(0, 90), CV_16UC1), mask;
    const int bright = random.uniform(5, 75);
    map.forEach<uint16_t>([&](uint16_t& value, const int*) { value = 100; });
    for (int y = 0; y < map.rows; ++y)
      for (int x = 0; x < map.cols; ++x)
        if (random.uniform(0, 100) < bright)
          map.at<uint16_t>(y, x) = static_cast<uint16_t>(random.uniform(30000, 65536));
    const Eigen::Vector2i peak(random.uniform(0, map.cols), random.uniform(0, map.rows));
    if (round % 3 == 0) {
      mask = cv::Mat(map.size(), CV_8UC1, cv::Scalar(255));
      mask(cv::Rect(random.uniform(0, map.cols - 5), random.uniform(0, map.rows - 5), 5, 5)) = 0;
      mask.at<uint8_t>(peak.y(), peak.x()) = 255;
    }
    const Plain plain = FillPlainly(map, mask, peak, 20000);
    const Flood::Outcome outcome = flood.Fill(map, mask, peak, 20000);
    ASSERT_EQ(outcome.unbounded, plain.unbounded) << "round " << round;
    ++(plain.unbounded ? unbounded : bounded);
    if (plain.unbounded) continue;
    EXPECT_EQ(outcome.touches_border, plain.touches_border) << "round " << round;
    Pixels found;
    std::vector<PixelRun> runs;
    flood.Runs(runs);
    size_t count = 0;
    for (const PixelRun& run : runs)
      for (int k = 0; k < run.length; ++k, ++count) found.insert({run.x + k, run.y});
    EXPECT_EQ(found, plain.pixels) << "round " << round;
    EXPECT_EQ(found.size(), count);
  }
  EXPECT_GT(bounded, 500);
  EXPECT_GT(unbounded, 100);
}

}  // namespace
}  // namespace glint
