#include "stereo/hollows.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <opencv2/core.hpp>
#include <optional>
#include <random>
#include <utility>

#include "core/parallel.h"
#include "io/project_images.h"
#include "sdf/csg.h"
#include "tests/stereo/textured_ball.h"
#include "tests/support/ball_mesh.h"

namespace glint {
namespace {

constexpr int kViews = 20;
const Eigen::Vector3d kHollowCenter(0, 0, 0.9);
constexpr double kHollowRadius = 0.45;
constexpr double kHollowVolume = 0.2211;  // what the unit ball loses to it

// Distances along the unit direction at which the ray enters and leaves a ball.
std::optional<std::pair<double, double>> Crossing(const Eigen::Vector3d& eye, const Eigen::Vector3d& direction,
                                                  const Eigen::Vector3d& center, double radius) {
  const double along = direction.dot(center - eye), across2 = (center - eye).squaredNorm() - along * along;
  if (across2 >= radius * radius) return std::nullopt;
  const double half = std::sqrt(radius * radius - across2);
  return std::pair(along - half, along + half);
}

// Changes over a fifth of the ball.
Eigen::Vector3d Paint(const Eigen::Vector3d& x) {
  return Eigen::Vector3d(120, 120, 120) + 40 * Eigen::Vector3d(std::sin(5 * x.x() + 3 * x.z()),
                                                               std::sin(5 * x.y() - 3 * x.z() + 1),
                                                               std::sin(4 * x.z() + 4 * x.x()));
}

// What a view shows of the lining of the hollow; nothing: there is no hollow.
using Lining = std::function<Eigen::Vector3d(const Eigen::Vector3d& x, size_t view)>;

class HollowsTest : public ::testing::Test {
 protected:
  HollowsTest() : scene_(testing::BallScene(kViews)) {
    Scene points = scene_;
    AddSphere(points, 400);
    for (const ScenePoint& p : points.points)
      if ((p.position - kHollowCenter).norm() > 1.2 * kHollowRadius) known_.push_back(p.position);
  }

  TriangleMesh Find(const Lining& lining) {
    std::vector<cv::Mat> images(kViews);
    ParallelFor(kViews, 1, [&](size_t v) { images[v] = Photograph(v, lining); });
    const SightColors colors(MemoryImages(images), 48, size_t{1} << 28, Progress::Silent());
    return FindHollows(scene_, colors, ball_, known_, &summary_);
  }

  cv::Mat Photograph(size_t v, const Lining& lining) const {
    const View& view = scene_.views[v];
    cv::Mat image(240, 320, CV_8UC3, cv::Scalar(90, 90, 90));
    const Eigen::Vector3d eye = view.Center();
    std::mt19937 random(static_cast<unsigned>(v));
    std::normal_distribution<double> noise(0, 2);
    for (int y = 0; y < image.rows; ++y)
      for (int x = 0; x < image.cols; ++x) {
        const Eigen::Vector3d direction = *view.RayThrough({x + 0.5, y + 0.5});
        const auto ball = Crossing(eye, direction, Eigen::Vector3d::Zero(), 1);
        if (!ball) continue;
        Eigen::Vector3d at = eye + ball->first * direction, color = Paint(at);
        if (const auto hollow = Crossing(eye, direction, kHollowCenter, kHollowRadius);
            lining && hollow && (at - kHollowCenter).norm() < kHollowRadius && hollow->second < ball->second) {
          at = eye + hollow->second * direction;
          color = lining(at, v);
        }
        for (int c = 0; c < 3; ++c) image.at<cv::Vec3b>(y, x)[c] = cv::saturate_cast<uint8_t>(color[c] + noise(random));
      }
    return image;
  }

  Scene scene_;
  const TriangleMesh ball_ = testing::BallMesh({0, 0, 0}, 1, 50);
  std::vector<Eigen::Vector3d> known_;
  HollowSummary summary_;
};

TEST_F(HollowsTest, AHollowIsFoundWhereItsLiningLooksAlikeFromAllSides) {
  const TriangleMesh hollows = Find([](const Eigen::Vector3d& x, size_t) { return Paint(x); });
  EXPECT_EQ(summary_.num_hollows, 1u);
  ASSERT_FALSE(hollows.empty());
  const TriangleMesh rest = Difference(ball_, hollows, 0.02);
  EXPECT_NEAR(SignedVolume(ball_) - SignedVolume(rest), kHollowVolume, 0.25 * kHollowVolume);
  std::vector<double> off;
  for (const Eigen::Vector3d& x : rest.vertices)
    if (x.norm() < 0.95) off.push_back(std::abs((x - kHollowCenter).norm() - kHollowRadius));
  ASSERT_GT(off.size(), 100u);
  std::nth_element(off.begin(), off.begin() + off.size() / 2, off.end());
  EXPECT_LT(off[off.size() / 2], 2.0 / 160 * Diagonal(ball_));  // two voxels
}

TEST_F(HollowsTest, WhatIsAsItSeemsIsLeft) {
  EXPECT_TRUE(Find({}).empty());
  EXPECT_GT(summary_.num_known, 1000u);
  EXPECT_LT(summary_.num_doubtful, ball_.faces.size() / 50);
}

// A mirror's picture changes with the view, and nothing behind its surface looks alike from all sides.
TEST_F(HollowsTest, AMirrorIsNoHollow) {
  const TriangleMesh hollows = Find([](const Eigen::Vector3d& x, size_t view) {
    const double turn = 2.4 * static_cast<double>(view);
    return Paint(3 * Eigen::Vector3d(std::sin(turn), std::cos(1.7 * turn), std::sin(0.6 * turn)) - x);
  });
  EXPECT_GT(summary_.num_doubtful, 0u);
  EXPECT_TRUE(hollows.empty());
}

TEST_F(HollowsTest, WithoutKnownPlacesNothingIsSaid) {
  known_.clear();
  EXPECT_TRUE(Find([](const Eigen::Vector3d& x, size_t) { return Paint(x); }).empty());
}

TEST(ColorSpread, IsTheMediansDistanceAndHardlySeesTheFew) {
  std::vector<Eigen::Array3f> colors(9, Eigen::Array3f(0.5F, 0.4F, 0.3F));
  colors[2] = colors[5] = Eigen::Array3f::Ones();
  EXPECT_EQ(ColorSpread(colors, 4), 0);
  colors.resize(3);
  EXPECT_TRUE(std::isinf(ColorSpread(colors, 4)));
  colors = {Eigen::Array3f::Constant(0.1F), Eigen::Array3f::Constant(0.2F), Eigen::Array3f::Constant(0.3F),
            Eigen::Array3f::Constant(0.4F), Eigen::Array3f::Constant(0.5F)};
  EXPECT_NEAR(ColorSpread(colors, 4), 0.1 * std::sqrt(3.0), 1e-6);
}

}  // namespace
}  // namespace glint
