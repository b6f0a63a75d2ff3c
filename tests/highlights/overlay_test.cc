#include "highlights/overlay.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

namespace glint {
namespace {

// Sums of blue, green and red that the drawing adds to a black image.
cv::Scalar Drawn(HighlightStatus status, int light) {
  Highlight h;
  h.px = {30, 30};
  h.moments_px = 9 * Eigen::Matrix2d::Identity();
  h.covariance_px = Eigen::Matrix2d::Identity();
  h.status = status;
  h.light = light;
  return cv::sum(DrawHighlights(cv::Mat(60, 60, CV_8UC3, cv::Scalar::all(0)), {h}));
}

TEST(Overlay, WhatNoLightIsKnownForIsNotDrawnAsAHighlight) {
  const cv::Scalar used = Drawn(HighlightStatus::kAccepted, 0), candidate = Drawn(HighlightStatus::kAccepted, -1),
                   rejected = Drawn(HighlightStatus::kStaysPut, 0);
  EXPECT_GT(used[1], 3 * used[2]);              // green
  EXPECT_GT(candidate[2], 1.1 * candidate[1]);  // amber
  EXPECT_GT(candidate[1], 2 * candidate[0]);
  EXPECT_GT(rejected[2], 3 * rejected[1]);  // red
}

TEST(Overlay, MasksCoverHighlightsAndNothingElse) {
  Highlight h;
  h.px = {30, 30};
  h.moments_px = 9 * Eigen::Matrix2d::Identity();
  h.covariance_px = Eigen::Matrix2d::Identity();
  const cv::Mat mask = HighlightMask(60, 60, {h}, 0);
  EXPECT_EQ(mask.at<uint8_t>(29, 29), 0);
  EXPECT_NEAR(cv::countNonZero(mask == 0), M_PI * 36, 20);  // two standard deviations
  h.status = HighlightStatus::kStaysPut;
  EXPECT_EQ(cv::countNonZero(HighlightMask(60, 60, {h}, 0) == 0), 0);
}

}  // namespace
}  // namespace glint
