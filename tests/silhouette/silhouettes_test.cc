#include "silhouette/silhouettes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/parallel.h"
#include "geometry/triangle_mesh.h"
#include "io/project_images.h"
#include "silhouette/hull.h"
#include "silhouette/support.h"
#include "tests/seed/simulated_scene.h"
#include "tests/silhouette/ring_scene.h"

namespace glint {
namespace {

constexpr int kViews = 24;
constexpr double kBallRadius = 1;

TriangleMesh Ball(double radius) {
  constexpr int kRings = 24, kSectors = 48;
  TriangleMesh mesh;
  for (int i = 0; i <= kRings; ++i)
    for (int j = 0; j < kSectors; ++j) {
      const double a = M_PI * i / kRings, b = 2 * M_PI * j / kSectors;
      mesh.vertices.emplace_back(radius * std::sin(a) * std::cos(b), radius * std::sin(a) * std::sin(b),
                                 radius * std::cos(a));
    }
  for (int i = 0; i < kRings; ++i)
    for (int j = 0; j < kSectors; ++j) {
      const int p = i * kSectors + j, q = i * kSectors + (j + 1) % kSectors;
      if (i > 0) mesh.faces.emplace_back(p, p + kSectors, q);
      if (i + 1 < kRings) mesh.faces.emplace_back(q, p + kSectors, q + kSectors);
    }
  return mesh;
}

// Whether the ray through a pixel meets the ball.
cv::Mat BallMask(const View& view, double radius) {
  cv::Mat mask(static_cast<int>(view.camera.height), static_cast<int>(view.camera.width), CV_8U, cv::Scalar(0));
  const Eigen::Vector3d eye = view.Center();
  for (int y = 0; y < mask.rows; ++y)
    for (int x = 0; x < mask.cols; ++x)
      if (eye.cross(*view.RayThrough({x + 0.5, y + 0.5})).norm() < radius) mask.at<uint8_t>(y, x) = 255;
  return mask;
}

// A bluish ball before a grey wall with noise.
cv::Mat Photograph(const cv::Mat& mask) {
  cv::Mat image(mask.size(), CV_8UC3, cv::Scalar(120, 125, 128)), noise(mask.size(), CV_8UC3);
  image.setTo(cv::Scalar(130, 70, 40), mask);
  cv::RNG(3).fill(noise, cv::RNG::UNIFORM, 0, 12);
  return image + noise;
}

class Outlines : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    Scene scene = DomeScene(kViews, 5);
    for (View& v : scene.views) v.camera = {1, CameraModel::kPinhole, 400, 300, {450, 450, 200, 150}};
    scene_ = new Scene(scene);
    masks_ = new std::vector<cv::Mat>;
    photographs_ = new std::vector<cv::Mat>;
    for (const View& v : scene_->views) {
      masks_->push_back(BallMask(v, kBallRadius));
      photographs_->push_back(Photograph(masks_->back()));
    }
  }
  static void TearDownTestSuite() {
    delete scene_;
    delete masks_;
    delete photographs_;
  }

  // 95 of 100 samples: their rays touch the ball to `across`, their places are on it to `place`.
  static void ExpectOnBall(const std::vector<OutlineSample>& outline, double across, double place) {
    std::vector<double> off_ray, off_place, turned_deg;
    for (const OutlineSample& s : outline) {
      const Eigen::Vector3d eye = scene_->views[s.view].Center();
      const Eigen::Vector3d x = eye + s.depth * s.ray;
      const Eigen::Vector3d normal = (eye - eye.dot(s.ray) * s.ray).normalized();
      off_ray.push_back(std::abs(eye.cross(s.ray).norm() - kBallRadius));
      off_place.push_back(std::abs(x.norm() - kBallRadius));
      turned_deg.push_back(std::acos(std::min(1.0, s.normal.dot(normal))) * 180 / M_PI);
      EXPECT_LE(s.near, s.depth);
      EXPECT_GE(s.far, s.depth);
      EXPECT_GT(s.sigma, 0);
      EXPECT_NEAR(s.normal.dot(s.ray), 0, 1e-9);
    }
    EXPECT_LT(Most(off_ray), across);
    EXPECT_LT(Most(off_place), place);
    EXPECT_LT(Most(turned_deg), 7);
  }

  static double Most(std::vector<double> values) {
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(values.size() * 95 / 100);
    std::nth_element(values.begin(), at, values.end());
    return *at;
  }

  static const Scene* scene_;
  static std::vector<cv::Mat>* masks_;
  static std::vector<cv::Mat>* photographs_;
};

const Scene* Outlines::scene_ = nullptr;
std::vector<cv::Mat>* Outlines::masks_ = nullptr;
std::vector<cv::Mat>* Outlines::photographs_ = nullptr;

TEST_F(Outlines, OfGivenMasksTouchTheBall) {
  const TriangleMesh rough = Ball(0.9);
  SilhouetteSummary summary;
  const Silhouettes s = FindSilhouettes(*scene_, MemoryImages(*photographs_, *masks_), {rough, {}}, {}, &summary);
  EXPECT_EQ(summary.source, "masks");
  EXPECT_EQ(summary.num_trusted_views, static_cast<size_t>(kViews));
  ASSERT_GT(s.outline().size(), 2000u);
  ExpectOnBall(s.outline(), 0.012, 0.03);
  EXPECT_LT(*s.OutsideBy({0, 0, 0}), -0.5);
  EXPECT_GT(*s.OutsideBy({1.3, 0, 0}), 0.1);
}

TEST_F(Outlines, AreFoundInPhotographs) {
  const TriangleMesh rough = Ball(0.9);
  SilhouetteSummary summary;
  const Silhouettes s = FindSilhouettes(*scene_, MemoryImages(*photographs_), {rough, {}}, {}, &summary);
  EXPECT_EQ(summary.source, "photographs");
  ASSERT_GT(s.outline().size(), 2000u);
  ExpectOnBall(s.outline(), 0.015, 0.03);
}

// From few sides most places have no other view's beside them.
TEST_F(Outlines, AreFoundFromFewSides) {
  Scene few;
  std::vector<cv::Mat> photographs;
  for (size_t i = 0; i < scene_->views.size(); i += scene_->views.size() / 8) {
    few.views.push_back(scene_->views[i]);
    photographs.push_back((*photographs_)[i]);
  }
  const TriangleMesh rough = Ball(0.9);
  SilhouetteSummary summary;
  const Silhouettes s = FindSilhouettes(few, MemoryImages(photographs), {rough, {}}, {}, &summary);
  EXPECT_EQ(summary.source, "photographs");
  EXPECT_EQ(summary.num_trusted_views, few.views.size());
  EXPECT_GT(s.outline().size(), 20u);
  EXPECT_GT(s.rays().size(), 600u);
  for (const OutlineSample& sample : s.rays())
    EXPECT_NEAR(few.views[sample.view].Center().cross(sample.ray).norm(), kBallRadius, 0.03);
}

// Every fourth mask lacks the upper half of the ball.
TEST_F(Outlines, HullOfMostIsTheBallWhereSomeMasksAreWrong) {
  std::vector<internal::ViewMask> masks;
  for (size_t i = 0; i < scene_->views.size(); ++i) {
    const View& view = scene_->views[i];
    cv::Mat mask = (*masks_)[i].clone();
    if (i % 4 == 0) mask.rowRange(0, mask.rows / 2).setTo(0);
    const internal::Raster raster{cv::Rect({0, 0}, mask.size()), 1, mask.size()};
    masks.push_back({i, raster, internal::SignedDistance(mask), view.Center(), 450});
  }
  const internal::Reach reach{{0.1, 0, 0}, 1.8};
  const TriangleMesh hull = internal::HullOfMost(*scene_, masks, reach, std::nullopt);
  ASSERT_FALSE(hull.empty());
  double least = 1e9;
  for (const Eigen::Vector3d& x : hull.vertices) least = std::min(least, x.norm());
  EXPECT_GT(least, 0.95 * kBallRadius);
  EXPECT_GT(SignedVolume(hull), 4.0 / 3 * M_PI * std::pow(kBallRadius, 3));
  EXPECT_LT(SignedVolume(hull), 1.5 * 4.0 / 3 * M_PI * std::pow(kBallRadius, 3));
  // The ground cuts it off.
  const Eigen::Hyperplane<double, 3> ground(Eigen::Vector3d::UnitZ(), 0.2);
  const TriangleMesh above = internal::HullOfMost(*scene_, masks, reach, ground);
  EXPECT_NEAR(BoundingBox(above).min().z(), -0.2, 1e-6);
}

TEST_F(Outlines, AreNoneWithoutPhotographs) {
  const TriangleMesh rough = Ball(0.9);
  SilhouetteSummary summary;
  const Silhouettes s = FindSilhouettes(*scene_, MemoryImages(std::vector<cv::Mat>(kViews)), {rough, {}}, {}, &summary);
  EXPECT_TRUE(s.outline().empty());
  EXPECT_EQ(summary.num_views, 0u);
  EXPECT_TRUE(internal::HullOfMost(*scene_, {}, {{0, 0, 0}, 2}, std::nullopt).empty());
}

TEST_F(Outlines, OfOneWrongViewAreLeftOut) {
  const TriangleMesh rough = Ball(0.9);
  std::vector<cv::Mat> masks = *masks_;
  cv::erode(masks[5], masks[5], cv::Mat(), cv::Point(-1, -1), 12);
  const Silhouettes s = FindSilhouettes(*scene_, MemoryImages(*photographs_, masks), {rough, {}});
  ASSERT_GT(s.outline().size(), 2000u);
  for (const OutlineSample& sample : s.outline()) EXPECT_NE(sample.view, 5u);
  ExpectOnBall(s.outline(), 0.012, 0.03);
}

TEST_F(Outlines, AreNotTakenFromMasksOfSomethingElse) {
  const TriangleMesh rough = Ball(0.9);
  std::vector<cv::Mat> masks;
  for (const cv::Mat& m : *masks_) {  // all but a few highlights
    masks.emplace_back(m.size(), CV_8U, cv::Scalar(255));
    cv::circle(masks.back(), {200, 150}, 9, cv::Scalar(0), cv::FILLED);
  }
  SilhouetteSummary summary;
  const Silhouettes s =
      FindSilhouettes(*scene_, MemoryImages(*photographs_, masks), {rough, {}}, {.use = "masks"}, &summary);
  EXPECT_TRUE(s.outline().empty());
  EXPECT_EQ(summary.source, "");
}

TEST_F(Outlines, ThatViewsDoNotConfirmAreDropped) {
  const TriangleMesh rough = Ball(0.9);
  std::vector<cv::Mat> noise;
  for (size_t i = 0; i < masks_->size(); ++i) {
    noise.emplace_back((*masks_)[i].size(), CV_8UC3);
    cv::RNG(100 + i).fill(noise.back(), cv::RNG::UNIFORM, 0, 255);
  }
  SilhouetteSummary summary;
  const Silhouettes s = FindSilhouettes(*scene_, MemoryImages(noise), {rough, {}}, {.max_views = 10}, &summary);
  EXPECT_LT(summary.num_trusted_samples, summary.num_samples / 2);
}

TEST_F(Outlines, AreTheSameForAnyNumberOfThreads) {
  const TriangleMesh rough = Ball(0.95);
  std::vector<std::vector<OutlineSample>> results;
  for (int threads : {1, 2}) {
    const ThreadLimit limit(threads);
    results.push_back(FindSilhouettes(*scene_, MemoryImages(*photographs_), {rough, {}}, {.max_views = 8}).outline());
  }
  ASSERT_EQ(results[0].size(), results[1].size());
  for (size_t i = 0; i < results[0].size(); ++i) {
    EXPECT_EQ(results[0][i].px, results[1][i].px);
    EXPECT_EQ(results[0][i].depth, results[1][i].depth);
  }
}

// Grey with a bluish ring.
std::vector<cv::Mat> PhotographsOf(const RingScene& ring) {
  std::vector<cv::Mat> photographs;
  for (const cv::Mat& mask : ring.masks) photographs.push_back(Photograph(mask));
  return photographs;
}

TEST(Holes, AreSeenThroughThoughTheRoughMeshSpansThem) {
  const RingScene ring;
  const Silhouettes s =
      FindSilhouettes(ring.scene, MemoryImages(PhotographsOf(ring)),
                      {RingScene::Disc(), std::vector<int8_t>(ring.scene.points.size(), 1)}, {.max_views = 12});
  ASSERT_GT(s.num_views(), 10u);
  ASSERT_TRUE(s.SeenThroughBy({0, 0, 0}, 3));
  // Aslant the ring covers some of it.
  EXPECT_GT(*s.SeenThroughBy({0, 0, 0}, 3), 0.3);
  EXPECT_LT(*s.SeenThroughBy({0, 0, 0}, 3), RingScene::kMajor - RingScene::kMinor);
  for (double turn = 0; turn < 6; turn += 1)
    EXPECT_LT(*s.SeenThroughBy({std::cos(turn), std::sin(turn), 0}, 3), 0) << turn;
  EXPECT_FALSE(s.SeenThroughBy({0, 0, 0}, s.num_views() + 1));
}

// What is painted like the background, with points around it, is not; nor is anything where too few points tell.
TEST(Holes, AreNotWhereThePointsAre) {
  RingScene ring;
  std::vector<cv::Mat> photographs = PhotographsOf(ring);
  const Silhouettes no_points =
      FindSilhouettes(ring.scene, MemoryImages(photographs),
                      {RingScene::Disc(), std::vector<int8_t>(ring.scene.points.size(), 0)}, {.max_views = 12});
  EXPECT_FALSE(no_points.SeenThroughBy({0, 0, 0}, 3));
  for (int i = 0; i < 600; ++i) {
    const double across = (RingScene::kMajor - RingScene::kMinor) * std::sqrt((i + 0.5) / 600), turn = 2.4 * i;
    AddPoint(ring.scene, {across * std::cos(turn), across * std::sin(turn), 0}, [](const auto&) { return true; });
  }
  const Silhouettes painted =
      FindSilhouettes(ring.scene, MemoryImages(photographs),
                      {RingScene::Disc(), std::vector<int8_t>(ring.scene.points.size(), 1)}, {.max_views = 12});
  EXPECT_FALSE(painted.SeenThroughBy({0, 0, 0}, 3));
}

TEST(OutlineNeighbors, SayHowFarOffASampleIs) {
  Scene scene = DomeScene(3, 5);
  std::vector<OutlineSample> outline;
  for (uint32_t v = 0; v < 3; ++v)
    for (int i = 0; i < 5; ++i) {
      // On the plane z = 0 that every ray touches, but the first sample 0.01 above it.
      const Eigen::Vector3d x(0.01 * i, 0.01 * v, v == 0 && i == 0 ? 0.01 : 0), eye = scene.views[v].Center();
      OutlineSample s;
      s.view = v;
      s.ray = (x - eye).normalized();
      s.depth = (x - eye).norm();
      s.px.setZero();
      s.normal = Eigen::Vector3d::UnitZ();
      outline.push_back(s);
    }
  const OutlineNeighbors neighbors(scene, outline);
  const Support first = neighbors.Of(0, 0.2), other = neighbors.Of(7, 0.2);
  EXPECT_EQ(first.views, 3u);
  EXPECT_EQ(first.samples, 15u);
  EXPECT_NEAR(first.offset, -0.01, 1e-9);
  EXPECT_NEAR(other.offset, 0, 1e-9);
}

}  // namespace
}  // namespace glint
