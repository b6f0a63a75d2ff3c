#include "synthetic/synthesize.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/core.hpp>

#include "core/error.h"
#include "core/parallel.h"
#include "synthetic/synthetic_image_source.h"

namespace glint {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

SyntheticOptions Small(std::string scene) {
  SyntheticOptions options;
  options.scene = std::move(scene);
  options.views = 12;
  options.width = 240;
  options.height = 180;
  options.object_points = 80;
  options.ground_points = 30;
  return options;
}

TEST(Synthesize, RejectsEveryOptionOutOfRange) {
  SyntheticOptions options = Small("sphere");
  options.views = 0;
  options.light_kind = "candle";
  try {
    SynthesizeScene(options);
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), testing::AllOf(testing::HasSubstr("views"), testing::HasSubstr("light_kind")));
  }
}

TEST(Synthesize, ModelIsConsistent) {
  for (const char* camera_model : {"PINHOLE", "SIMPLE_RADIAL", "OPENCV"}) {
    SyntheticOptions options = Small("blob");
    options.camera_model = camera_model;
    options.scale = 25;
    const SyntheticScene scene = SynthesizeScene(options);
    const Model& model = scene.model;
    ASSERT_EQ(model.images.size(), 12u);
    ASSERT_EQ(model.points.size(), scene.point_origins.size());
    const Camera& camera = model.cameras.at(1);
    for (size_t i = 0; i < model.points.size(); ++i) {
      const Point3D& point = model.points[i];
      ASSERT_GE(point.track.size(), 3u);
      double error = 0;
      for (const TrackElement& element : point.track) {
        const Image& image = model.images[element.image_id - 1];
        ASSERT_EQ(image.id, element.image_id);
        const Point2D& seen = image.points2d.at(element.point2d_index);
        ASSERT_EQ(seen.point3d_id, point.id);
        error += (*ProjectToPixel(camera, image.cam_from_world * point.xyz) - seen.px).norm();
      }
      EXPECT_NEAR(point.error_px, error / static_cast<double>(point.track.size()), 1e-6);
      const double distance = scene.shape->Value(point.xyz);
      if (scene.point_origins[i] == SyntheticPoint::Origin::kMark) {
        EXPECT_LT(std::abs(distance), 0.1 * 25);
      }
      if (scene.point_origins[i] == SyntheticPoint::Origin::kGround) {
        EXPECT_GT(distance, -0.1 * 25);
      }
    }
    for (const Image& image : model.images)
      for (size_t k = 0; k < image.points2d.size(); ++k) {
        const uint64_t id = image.points2d[k].point3d_id;
        if (id == kInvalidPoint3DId) continue;
        const auto& track = model.points.at(id - 1).track;
        EXPECT_EQ(std::count_if(track.begin(), track.end(),
                                [&](const TrackElement& e) { return e.image_id == image.id && e.point2d_index == k; }),
                  1);
      }
  }
}

TEST(Synthesize, PointsFollowTheOptions) {
  SyntheticOptions options = Small("sphere");
  options.views = 24;
  options.object_points = 250;
  options.glossy_share = 34.0 / 250;
  options.virtual_share = 0.04;
  const SyntheticScene scene = SynthesizeScene(options);
  int marks = 0, upper = 0, virtual_points = 0, behind = 0;
  std::vector<double> distances;
  for (size_t i = 0; i < scene.model.points.size(); ++i) {
    const Vector3d x = scene.world_from_stage.InverseOf(scene.model.points[i].xyz);
    if (scene.point_origins[i] == SyntheticPoint::Origin::kMark) {
      ++marks;
      upper += x.z() > scene.stage->marks.median_height();
      distances.push_back(std::abs(scene.shape->Value(scene.model.points[i].xyz)));
    } else if (scene.point_origins[i] == SyntheticPoint::Origin::kHighlight) {
      ++virtual_points;
      behind += scene.shape->Value(scene.model.points[i].xyz) < -0.05;
    }
  }
  EXPECT_EQ(marks, 250);
  EXPECT_NEAR(upper, 34, 3);
  std::nth_element(distances.begin(), distances.begin() + distances.size() / 2, distances.end());
  EXPECT_LT(distances[distances.size() / 2], 0.02);  // half a pixel of 240
  EXPECT_GT(virtual_points, 0);
  EXPECT_GT(behind, 0.7 * virtual_points);  // a convex mirror's image of the light lies behind it
}

TEST(Synthesize, NoNoisePutsPointsOnTheirSurfaces) {
  SyntheticOptions options = Small("touching");
  options.point_noise_px = 0;
  options.virtual_share = 0;
  const SyntheticScene scene = SynthesizeScene(options);
  for (size_t i = 0; i < scene.model.points.size(); ++i) {
    EXPECT_LT(scene.model.points[i].error_px, 1e-6);
    if (scene.point_origins[i] == SyntheticPoint::Origin::kMark) {
      EXPECT_LT(std::abs(scene.shape->Value(scene.model.points[i].xyz)), 1e-7);
    }
  }
}

TEST(Render, SameAtAnyNumberOfThreads) {
  SyntheticOptions options = Small("hood");
  options.light_angle_deg = 2;
  options.lights = 2;
  cv::Mat images[2];
  ViewTruth truths[2];
  std::vector<Point3D> points[2];
  for (int i = 0; i < 2; ++i) {
    const ThreadLimit limit(i + 1);
    const SyntheticScene scene = SynthesizeScene(options);
    points[i] = scene.model.points;
    RenderView(scene, 5, images[i], truths[i]);
  }
  EXPECT_EQ(cv::norm(images[0], images[1], cv::NORM_INF), 0);
  EXPECT_EQ(truths[0].specular, truths[1].specular);
  ASSERT_EQ(points[0].size(), points[1].size());
  for (size_t i = 0; i < points[0].size(); ++i) EXPECT_EQ(points[0][i].xyz, points[1][i].xyz);
}

TEST(Render, ImagesDoNotDependOnTheWorldsFrame) {
  SyntheticOptions options = Small("torus");
  SyntheticOptions other = options;
  other.scale = 1e4;
  options.place = false;
  cv::Mat a, b;
  ViewTruth truth;
  RenderView(SynthesizeScene(options), 3, a, truth);
  RenderView(SynthesizeScene(other), 3, b, truth);
  EXPECT_EQ(cv::norm(a, b, cv::NORM_INF), 0);
}

// Every vertex of the true mesh that faces the camera projects onto the object's mask (or a pixel beside it), and the
// mask is no larger than these projections reach.
TEST(Render, MaskAgreesWithTheModelsCamera) {
  for (const char* camera_model : {"PINHOLE", "SIMPLE_RADIAL", "OPENCV"}) {
    SyntheticOptions options = Small("ellipsoid");
    options.camera_model = camera_model;
    const SyntheticScene scene = SynthesizeScene(options);
    const TriangleMesh mesh = TrueMesh(scene, 100);
    cv::Mat image;
    ViewTruth truth;
    RenderView(scene, 7, image, truth);
    Vector2d low(1e9, 1e9), high(-1e9, -1e9);
    for (const Vector3d& x : mesh.vertices) {
      const Vector2d px = *ProjectToPixel(scene.model.cameras.at(1), scene.model.images[7].cam_from_world * x);
      low = low.cwiseMin(px);
      high = high.cwiseMax(px);
    }
    Vector2d mask_low(1e9, 1e9), mask_high(-1e9, -1e9);
    for (int y = 0; y < truth.height; ++y)
      for (int x = 0; x < truth.width; ++x)
        if (truth.object_mask[static_cast<size_t>(y) * truth.width + x]) {
          mask_low = mask_low.cwiseMin(Vector2d(x, y));
          mask_high = mask_high.cwiseMax(Vector2d(x + 1, y + 1));
        }
    EXPECT_LT((mask_low - low).cwiseAbs().maxCoeff(), 1.2) << camera_model;
    EXPECT_LT((mask_high - high).cwiseAbs().maxCoeff(), 1.2) << camera_model;
  }
}

TEST(Render, ObjectFillsMostOfTheFrameInEveryView) {
  for (std::string_view name : ShapeNames()) {
    const SyntheticScene scene = SynthesizeScene(Small(std::string(name)));
    const TriangleMesh mesh = TrueMesh(scene, 40);
    for (const Image& image : scene.model.images) {
      Eigen::AlignedBox2d box;
      for (const Vector3d& x : mesh.vertices)
        box.extend(*ProjectToPixel(scene.model.cameras.at(1), image.cam_from_world * x));
      EXPECT_GT(std::max(box.sizes().x() / 240, box.sizes().y() / 180), 0.55) << name;
      EXPECT_TRUE(Eigen::AlignedBox2d(Vector2d(0, 0), Vector2d(240, 180)).contains(box)) << name;
    }
  }
}

TEST(ImageSource, GivesTheViewsAndMasks) {
  SyntheticOptions options = Small("sphere");
  options.jpeg_quality = 0;
  const SyntheticImageSource source(SynthesizeScene(options), true);
  ASSERT_EQ(source.size(), 12u);
  cv::Mat image, mask, direct;
  ViewTruth truth;
  ASSERT_TRUE(source.Load(4, image));
  ASSERT_TRUE(source.LoadMask(4, mask));
  RenderView(source.scene(), 4, direct, truth);
  EXPECT_EQ(cv::norm(image, direct, cv::NORM_INF), 0);
  EXPECT_EQ(cv::countNonZero(mask), std::count(truth.object_mask.begin(), truth.object_mask.end(), 255));
  EXPECT_GT(cv::countNonZero(mask), 240 * 180 / 5);
  const SyntheticImageSource unmasked(SynthesizeScene(options));
  EXPECT_FALSE(unmasked.LoadMask(4, mask));
  // Many threads ask for the same views.
  std::vector<cv::Mat> images(24);
  ParallelFor(images.size(), 1, [&](size_t i) { unmasked.Load(i % 12, images[i]); });
  for (size_t i = 0; i < 12; ++i) EXPECT_EQ(cv::norm(images[i], images[i + 12], cv::NORM_INF), 0);
}

TEST(Render, NoiseAndLossArePresentAsAsked) {
  SyntheticOptions options = Small("sphere");
  options.noise_levels = 0;
  cv::Mat clean, noisy;
  ViewTruth truth;
  RenderView(SynthesizeScene(options), 0, clean, truth);
  options.noise_levels = 3;
  RenderView(SynthesizeScene(options), 0, noisy, truth);
  cv::Mat difference;
  cv::subtract(noisy, clean, difference, cv::noArray(), CV_32F);
  cv::Scalar mean, deviation;
  cv::meanStdDev(difference, mean, deviation);
  EXPECT_NEAR(deviation[1], 3, 0.15);
  EXPECT_NEAR(mean[1], 0, 0.1);
}

}  // namespace
}  // namespace glint
