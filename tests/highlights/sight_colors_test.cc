#include "highlights/sight_colors.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <vector>

#include "io/project_images.h"

namespace glint {
namespace {

constexpr size_t kMemory = size_t{1} << 24;

SightColors ColorsOf(const std::vector<cv::Mat>& images, const std::vector<cv::Mat>& masks = {},
                     size_t most_views = 100) {
  return {MemoryImages(images, masks), most_views, kMemory, Progress::Silent()};
}

TEST(SightColors, OfAnEvenImageAreItsColourEverywhere) {
  const SightColors colors = ColorsOf({cv::Mat(5, 7, CV_8UC3, cv::Scalar(50, 100, 180))});
  ASSERT_TRUE(colors.Has(0));
  const auto corner = colors.At(0, {0.5, 0.5}), middle = colors.At(0, {3.3, 2.1}), last = colors.At(0, {6.5, 4.5});
  ASSERT_TRUE(corner && middle && last);
  EXPECT_LT((*corner - *middle).abs().maxCoeff(), 1e-4F);
  EXPECT_LT((*corner - *last).abs().maxCoeff(), 1e-4F);
  EXPECT_GT(middle->x(), middle->y());
  EXPECT_GT(middle->y(), middle->z());
  for (const Eigen::Vector2d& off : {Eigen::Vector2d(-1, 2), {8, 2}, {3, std::nan("")}})
    EXPECT_FALSE(colors.At(0, off));
}

// One pixel has no neighbour to be mixed with.
TEST(SightColors, OfImagesOnePixelWideOrHigh) {
  for (const cv::Size& size : {cv::Size(1, 1), cv::Size(1, 9), cv::Size(9, 1)}) {
    const SightColors colors = ColorsOf({cv::Mat(size, CV_8UC3, cv::Scalar::all(128))});
    const auto first = colors.At(0, {0.5, 0.5}), last = colors.At(0, {size.width - 0.5, size.height - 0.5});
    ASSERT_TRUE(first && last) << size;
    EXPECT_LT((*first - *last).abs().maxCoeff(), 1e-4F) << size;
  }
}

TEST(SightColors, NothingIsSaidOfWhatIsIgnoredCutOffOrNotThere) {
  const cv::Mat grey(6, 6, CV_8UC3, cv::Scalar::all(90)), white(6, 6, CV_8UC3, cv::Scalar::all(255));
  const cv::Mat nothing(6, 6, CV_8U, cv::Scalar(0));
  const SightColors colors = ColorsOf({grey, white, cv::Mat()}, {nothing, cv::Mat(), cv::Mat()});
  EXPECT_FALSE(colors.At(0, {3, 3}));
  EXPECT_FALSE(colors.At(1, {3, 3}));
  EXPECT_FALSE(colors.Has(2));
}

TEST(SightColors, AtMostSoManyViewsAreRead) {
  const cv::Mat grey(6, 6, CV_8UC3, cv::Scalar::all(90));
  const SightColors colors = ColorsOf(std::vector<cv::Mat>(9, grey), {}, 3);
  size_t read = 0;
  for (size_t v = 0; v < 9; ++v) read += colors.Has(v);
  EXPECT_EQ(read, 3U);
}

}  // namespace
}  // namespace glint
