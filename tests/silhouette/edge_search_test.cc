#include "silhouette/edge_search.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "core/median.h"

namespace glint::internal {
namespace {

constexpr int kSide = 1200, kRasterSide = 300;
const Eigen::Vector2d kCenter(611.3, 587.8);  // of the photograph

// A disc whose colour goes over into that of the surroundings as it would on a glossy ball, seen by square pixels.
cv::Mat Disc(double radius, bool glossy) {
  constexpr int kSubpixels = 4;
  cv::Mat image(kSide, kSide, CV_8UC3);
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      cv::Vec3d sum(0, 0, 0);
      for (int k = 0; k < kSubpixels * kSubpixels; ++k) {
        const Eigen::Vector2d at(x + (k % kSubpixels + 0.5) / kSubpixels, y + (k / kSubpixels + 0.5) / kSubpixels);
        const double r = (at - kCenter).norm() / radius;
        // Schlick's term: what the rim mirrors instead of its own colour.
        const double mirrored = glossy && r < 1 ? std::pow(1 - std::sqrt(1 - r * r), 5) : 0;
        const cv::Vec3d own(40, 60, 170), around(180, 185, 190);
        sum += r < 1 ? own + mirrored * (around - own) : around;
      }
      image.at<cv::Vec3b>(y, x) = sum / (kSubpixels * kSubpixels);
    }
  return image;
}

// How far the points that are found are outside of the disc, px of the photograph: all of them, and in the middle.
struct Off {
  double largest = 0, median = 0;
};
Off OffTheDisc(const cv::Mat& image, double radius, bool fine) {
  const Raster raster{cv::Rect(0, 0, kSide, kSide), double{kRasterSide} / kSide, cv::Size(kRasterSide, kRasterSide)};
  cv::Mat small, gray;
  cv::resize(image, small, raster.size, 0, 0, cv::INTER_AREA);
  cv::extractChannel(small, gray, 0);
  std::vector<ContourPoint> points = OnEdges(small, Contour(SignedDistance(gray < 110), 2));
  EXPECT_GT(points.size(), 100);
  if (fine) points = OnFineEdges(image, raster, true, points);
  Off off;
  std::vector<double> all;
  for (const ContourPoint& p : points) {
    all.push_back((raster.ToImage(p.at) - kCenter).norm() - radius);
    off.largest = std::max(off.largest, std::abs(all.back()));
  }
  off.median = Median(all);
  return off;
}

TEST(OnFineEdges, FindsADisc) {
  const Off off = OffTheDisc(Disc(401.7, false), 401.7, true);
  EXPECT_LT(std::abs(off.median), 0.4);
  EXPECT_LT(off.largest, 1);
}

TEST(OnFineEdges, IsNearerToAGlossyRimThanTheRaster) {
  const cv::Mat image = Disc(401.7, true);
  const Off coarse = OffTheDisc(image, 401.7, false), fine = OffTheDisc(image, 401.7, true);
  EXPECT_LT(std::abs(fine.median), 0.5 * std::abs(coarse.median));
  EXPECT_LT(std::abs(fine.median), 0.8);
}

TEST(OnFineEdges, LeavesAsItIsWhatIsNoSmaller) {
  const cv::Mat image = Disc(401.7, false);
  const Raster same{cv::Rect(0, 0, kSide, kSide), 1, cv::Size(kSide, kSide)};
  const std::vector<ContourPoint> points = {{{1012.4, 587.8}, {1, 0}}};
  EXPECT_EQ(OnFineEdges(image, same, true, points)[0].at, points[0].at);
}

TEST(OnFineEdges, LeavesAsItIsWhatHasNoEdge) {
  const Raster raster{cv::Rect(0, 0, kSide, kSide), double{kRasterSide} / kSide, cv::Size(kRasterSide, kRasterSide)};
  const std::vector<ContourPoint> points = {{{120.3, 87.9}, {0.6, 0.8}}};
  EXPECT_EQ(OnFineEdges(cv::Mat(kSide, kSide, CV_8UC3, cv::Scalar(9, 9, 9)), raster, true, points)[0].at, points[0].at);
  // A line of one pixel, with the same on both sides of it: its edge, wherever that is, is near.
  cv::Mat line(kSide, kSide, CV_8UC3, cv::Scalar(9, 9, 9));
  cv::line(line, {0, 352}, {kSide - 1, 352}, cv::Scalar(200, 200, 200));
  const std::vector<ContourPoint> on_it = {{{120, 88}, {0, 1}}};
  EXPECT_LT((OnFineEdges(line, raster, true, on_it)[0].at - on_it[0].at).norm(), 1);
}

}  // namespace
}  // namespace glint::internal
