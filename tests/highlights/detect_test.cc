#include "highlights/detect.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <random>

#include "core/square.h"

namespace glint {
namespace {

using Status = HighlightStatus;

double SrgbFromLinear(double x) { return x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055; }

struct Lobe {
  Eigen::Vector2d px;  // COLMAP's frame
  double major_px;     // half-height radii
  double minor_px;
  double angle = 0;        // of the major axis
  double amplitude = 0.6;  // linear, above 1 - body it saturates
};

// A GGX-like lobe, integrated over 3 × 3 points a pixel, over a body of one colour (BGR, linear).
cv::Mat Render(const Lobe& lobe, const Eigen::Vector3d& body, const Eigen::Vector3d& light = {1, 1, 1},
               int depth = CV_8U, int width = 320, int height = 240, double noise = 0) {
  cv::Mat image(height, width, CV_MAKETYPE(depth, 3));
  const double white = depth == CV_8U ? 255 : 65535;
  const Eigen::Matrix2d turn = Eigen::Rotation2Dd(-lobe.angle).toRotationMatrix();
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      double specular = 0;
      for (int s = 0; s < 9; ++s) {
        const Eigen::Vector2d d = turn * (Eigen::Vector2d(x + (s % 3 + 0.5) / 3, y + (s / 3 + 0.5) / 3) - lobe.px);
        const double q = 0.41421356 * (Square(d.x() / lobe.major_px) + Square(d.y() / lobe.minor_px));
        specular += lobe.amplitude / ((1 + q) * (1 + q)) / 9;
      }
      for (int c = 0; c < 3; ++c) {
        const double code =
            white * SrgbFromLinear(std::min(1.0, body[c] + specular * light[c])) + noise * white / 255 * normal(random);
        const double rounded = std::clamp(std::round(code), 0.0, white);
        if (depth == CV_8U)
          image.ptr<uint8_t>(y)[3 * x + c] = static_cast<uint8_t>(rounded);
        else
          image.ptr<uint16_t>(y)[3 * x + c] = static_cast<uint16_t>(rounded);
      }
    }
  return image;
}

std::vector<Highlight> Accepted(const cv::Mat& image, const cv::Mat& mask = {}) {
  std::vector<Highlight> accepted;
  for (const Highlight& h : DetectHighlights(image, mask, 3, {}))
    if (h.status == Status::kAccepted) accepted.push_back(h);
  return accepted;
}

const Eigen::Vector3d kBlack(0.01, 0.01, 0.01), kTeal(0.2, 0.15, 0.03), kWhite(0.6, 0.6, 0.6), kGold(0.05, 0.2, 0.3);

TEST(Detect, PeakToATenthOfAPixelOnEveryBaseAndSize) {
  for (const Eigen::Vector3d& body : {kBlack, kTeal, kWhite})
    for (const double size : {1.2, 3.0, 8.0, 20.0, 45.0}) {
      const Lobe lobe{{157.31, 121.78}, size, 0.7 * size, 0.6, 0.3};
      const auto found = Accepted(Render(lobe, body, {1, 1, 1}, CV_8U, 320, 240, 0.7));
      ASSERT_EQ(found.size(), 1u) << size << " on " << body.transpose();
      EXPECT_LT((found[0].px - lobe.px).norm(), std::max(0.1, 0.01 * size)) << size << " on " << body.transpose();
      EXPECT_EQ(found[0].view, 3u);
    }
}

TEST(Detect, SaturatedCoreIsFittedFromItsRim) {
  for (const double amplitude : {2.0, 6.0, 20.0}) {
    // A mark on one side drags a centroid, not the fit.
    const Lobe lobe{{150.2, 118.6}, 6, 5, 0.3, amplitude};
    cv::Mat image = Render(lobe, kTeal);
    const auto found = Accepted(image);
    ASSERT_EQ(found.size(), 1u) << amplitude;
    EXPECT_LT((found[0].px - lobe.px).norm(), 0.15) << amplitude;
    EXPECT_GT(found[0].saturated_fraction, 0.03);
  }
}

TEST(Detect, CovarianceCoversTheErrorAndFollowsTheStreak) {
  const Lobe streak{{160.4, 120.3}, 45, 3, 0.5, 0.5};
  const auto found = Accepted(Render(streak, kTeal, {1, 1, 1}, CV_8U, 320, 240, 1.0));
  ASSERT_EQ(found.size(), 1u);
  const Eigen::Vector2d along(std::cos(0.5), std::sin(0.5)), across(-along.y(), along.x());
  const Eigen::Matrix2d& covariance = found[0].covariance_px;
  EXPECT_GT(along.dot(covariance * along), 9 * across.dot(covariance * across));
  const Eigen::Vector2d error = found[0].px - streak.px;
  EXPECT_LT(error.dot(covariance.inverse() * error), 9);
  EXPECT_GT(along.dot(found[0].moments_px * along), 50 * across.dot(found[0].moments_px * across));
}

TEST(Detect, EightAndSixteenBitAndGreyAgree) {
  const Lobe lobe{{100.7, 90.2}, 5, 4, 0.2, 0.5};
  const auto eight = Accepted(Render(lobe, kWhite * 0.3));
  const cv::Mat deep = Render(lobe, kWhite * 0.3, {1, 1, 1}, CV_16U);
  const auto sixteen = Accepted(deep);
  cv::Mat grey;
  cv::extractChannel(deep, grey, 0);
  const auto one_channel = Accepted(grey);
  ASSERT_EQ(eight.size(), 1u);
  ASSERT_EQ(sixteen.size(), 1u);
  ASSERT_EQ(one_channel.size(), 1u);
  EXPECT_LT((eight[0].px - sixteen[0].px).norm(), 0.03);
  EXPECT_LT((sixteen[0].px - one_channel[0].px).norm(), 1e-6);
  EXPECT_NEAR(eight[0].strength, 0.5, 0.05);
}

TEST(Detect, MetalKeepsItsColourPaintDoesNot) {
  const Lobe lobe{{150, 120}, 6, 5, 0, 1.0};
  EXPECT_EQ(Accepted(Render(lobe, kGold, {0.25, 0.7, 1})).size(), 1u) << "golden highlight on gold";
  // An orange blob on teal.
  for (const Highlight& h : DetectHighlights(Render(lobe, kTeal, {0.05, 0.3, 0.8}), {}, 0, {}))
    EXPECT_NE(h.status, Status::kAccepted);
}

TEST(Detect, PrintIsNoLobe) {
  cv::Mat image(240, 320, CV_8UC3, cv::Scalar(110, 100, 40));
  cv::circle(image, {160, 120}, 14, cv::Scalar(200, 200, 200), cv::FILLED, cv::LINE_AA);
  cv::putText(image, "STRONG", {30, 60}, cv::FONT_HERSHEY_SIMPLEX, 1, cv::Scalar(210, 210, 210), 3, cv::LINE_AA);
  const auto all = DetectHighlights(image, {}, 0, {});
  ASSERT_FALSE(all.empty());
  size_t disc = 0;
  for (const Highlight& h : all)
    if ((h.px - Eigen::Vector2d(160, 120)).norm() < 10) {
      ++disc;
      EXPECT_EQ(h.status, Status::kNotALobe);
    }
  EXPECT_GT(disc, 0u);
}

TEST(Detect, WhatTheBorderOrTheMaskCutsIsSaid) {
  const cv::Mat image = Render({{2, 120}, 10, 8, 0, 0.5}, kTeal);
  const auto cut = DetectHighlights(image, {}, 0, {});
  ASSERT_FALSE(cut.empty());
  EXPECT_EQ(cut[0].status, Status::kAtBorder);

  const cv::Mat inside = Render({{160, 120}, 6, 5, 0, 0.5}, kTeal);
  cv::Mat mask(inside.size(), CV_8UC1, cv::Scalar(255));
  EXPECT_EQ(Accepted(inside, mask).size(), 1u);
  mask.setTo(0);
  EXPECT_TRUE(DetectHighlights(inside, mask, 0, {}).empty());
  mask(cv::Rect(0, 0, 162, 240)).setTo(255);
  for (const Highlight& h : DetectHighlights(inside, mask, 0, {})) EXPECT_EQ(h.status, Status::kAtBorder);
}

TEST(Detect, NothingInFlatNoisyOrSaturatedImages) {
  for (const double level : {0.0, 0.2, 1.0})
    EXPECT_TRUE(Accepted(Render({{100, 100}, 5, 5, 0, 0}, Eigen::Vector3d::Constant(level))).empty()) << level;
  EXPECT_TRUE(Accepted(Render({{100, 100}, 5, 5, 0, 0}, kTeal, {1, 1, 1}, CV_8U, 320, 240, 1.5)).empty());
  cv::Mat sky(240, 320, CV_8UC3, cv::Scalar(60, 60, 60));
  sky(cv::Rect(0, 0, 320, 110)).setTo(cv::Scalar(255, 255, 255));
  EXPECT_TRUE(Accepted(sky).empty());
}

TEST(Detect, TinyImagesAreSurvived) {
  for (const int side : {1, 2, 3, 7, 23}) {
    cv::Mat image(side, side, CV_8UC3, cv::Scalar(30, 30, 30));
    image.at<cv::Vec3b>(side / 2, side / 2) = {255, 255, 255};
    EXPECT_NO_THROW(DetectHighlights(image, {}, 0, {})) << side;
  }
}

TEST(Detect, SurvivesJpegAtEighty) {
  const Lobe lobe{{157.3, 121.8}, 4, 3, 0.6, 1.5};
  std::vector<uint8_t> bytes;
  cv::imencode(".jpg", Render(lobe, kTeal, {1, 1, 1}, CV_8U, 320, 240, 1.0), bytes, {cv::IMWRITE_JPEG_QUALITY, 80});
  const auto found = Accepted(cv::imdecode(bytes, cv::IMREAD_COLOR));
  ASSERT_GE(found.size(), 1u);
  EXPECT_LT((found[0].px - lobe.px).norm(), 0.25);
}

TEST(Detect, OptionsDeclareTheirRanges) {
  EXPECT_TRUE(Violations(DetectOptions{}).empty());
  DetectOptions bad;
  bad.min_strength = -1;
  bad.saturation = 2;
  EXPECT_EQ(Violations(bad).size(), 2u);
}

}  // namespace
}  // namespace glint
