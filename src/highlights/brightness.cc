#include "highlights/brightness.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <vector>

#include "core/check.h"
#include "highlights/row_kernel.h"

namespace glint {
namespace {

std::vector<uint16_t> LinearTable(int codes) {
  std::vector<uint16_t> table(codes);
  for (int c = 0; c < codes; ++c)
    table[c] = static_cast<uint16_t>(std::lround(65535 * LinearFromSrgb(c / double(codes - 1))));
  return table;
}

// Per depth: code -> linear in 65535ths.
template <class T>
const std::vector<uint16_t>& Table() {
  static const std::vector<uint16_t> table = LinearTable(1 << (8 * sizeof(T)));
  return table;
}

// sRGB is monotonic: the minimum of the codes is the minimum of the linear values.
template <class T, int kChannels>
void MinChannelRows(const cv::Mat& image, cv::Mat& out) {
  const uint16_t* table = Table<T>().data();
  std::vector<T> least(image.cols);
  for (int y = 0; y < image.rows; ++y) {
    const T* in = image.ptr<T>(y);
    uint16_t* to = out.ptr<uint16_t>(y);
    if constexpr (sizeof(T) == 1 && kChannels == 3)
      internal::LeastOfThreeRow(in, least.size(), least.data());
    else
      for (size_t x = 0; x < least.size(); ++x, in += kChannels)
        least[x] = kChannels == 1 ? in[0] : std::min(in[0], std::min(in[1 % kChannels], in[2 % kChannels]));
    for (size_t x = 0; x < least.size(); ++x) to[x] = table[least[x]];
  }
}

template <class T>
void MinChannel(const cv::Mat& image, cv::Mat& out) {
  switch (image.channels()) {
    case 1:
      return MinChannelRows<T, 1>(image, out);
    case 3:
      return MinChannelRows<T, 3>(image, out);
    default:
      return MinChannelRows<T, 4>(image, out);
  }
}

}  // namespace

double LinearFromSrgb(double code) { return code <= 0.04045 ? code / 12.92 : std::pow((code + 0.055) / 1.055, 2.4); }

cv::Mat LinearMinChannel(const cv::Mat& image) {
  GLINT_CHECK(image.depth() == CV_8U || image.depth() == CV_16U);
  GLINT_CHECK(image.channels() == 1 || image.channels() == 3 || image.channels() == 4);
  cv::Mat out(image.size(), CV_16UC1);
  if (image.depth() == CV_8U)
    MinChannel<uint8_t>(image, out);
  else
    MinChannel<uint16_t>(image, out);
  return out;
}

cv::Mat LinearColors(const cv::Mat& image) {
  cv::Mat out(image.size(), CV_16UC3);
  const int channels = image.channels();
  for (int y = 0; y < image.rows; ++y) {
    auto* to = out.ptr<cv::Vec3w>(y);
    for (int x = 0; x < image.cols; ++x)
      for (int c = 0; c < 3; ++c) {
        const int k = x * channels + (channels == 1 ? 0 : c);
        to[x][c] = image.depth() == CV_8U ? Table<uint8_t>()[image.ptr<uint8_t>(y)[k]]
                                          : Table<uint16_t>()[image.ptr<uint16_t>(y)[k]];
      }
  }
  return out;
}

LinearColorReader::LinearColorReader(const cv::Mat& image)
    : image_(image),
      table_(image.depth() == CV_8U ? Table<uint8_t>().data() : Table<uint16_t>().data()),
      channels_(image.channels()),
      green_(channels_ == 1 ? 0 : 1),
      red_(channels_ == 1 ? 0 : 2),
      is_8_bit_(image.depth() == CV_8U) {}

}  // namespace glint
