// What is connected to a peak: flood fill in a small window, a row of it at a time.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

namespace glint {

// Pixels of a row side by side.
struct PixelRun {
  int x, y, length;
};

class Flood {
 public:
  static constexpr int kWindow = 31;  // half side
  static constexpr int kMaxPixels = 900;

  struct Outcome {
    bool unbounded;       // reaches the window's border, or is larger than kMaxPixels: Runs() are some of it
    bool touches_border;  // of the image, or of the mask
  };

  // Everything 4-connected to `peak` above `threshold`. `map`: CV_16UC1; `mask`: CV_8UC1 of its size or empty, 0 is
  // ignored.
  Outcome Fill(const cv::Mat& map, const cv::Mat& mask, const Eigen::Vector2i& peak, uint16_t threshold);

  // What was filled last, from top to bottom.
  void Runs(std::vector<PixelRun>& runs) const;

 private:
  static constexpr int kRows = 2 * kWindow + 1;
  // A row of the window, a bit a pixel.
  struct Row {
    uint64_t valid;  // on the image and the mask
    uint64_t above;  // the threshold
    uint64_t filled;
  };

  // Row `index`, made when it is first asked for.
  Row& At(int index);
  // Lets the fill of row `from` flow into row `to`; false if nothing changes.
  bool Flow(int from, int to);
  // Down and up until nothing changes; false where it is unbounded.
  bool Spill();

  std::array<Row, kRows> rows_;
  int first_ = 0, last_ = 0;  // rows made
  int top_ = 0, bottom_ = 0;  // rows with something filled
  const cv::Mat* map_ = nullptr;
  const cv::Mat* mask_ = nullptr;
  Eigen::Vector2i corner_;  // of the window
  uint16_t threshold_ = 0;
};

}  // namespace glint
