#include "colmap/scene.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/colmap/test_model.h"

namespace glint {
namespace {

using testing_support::SmallModel;

TEST(Scene, ViewsAreSortedByNameAndObservationsPointToThem) {
  const Model model = SmallModel();
  const Scene scene = MakeScene(model);
  ASSERT_EQ(scene.views.size(), 4);
  for (size_t i = 1; i < 4; ++i) EXPECT_LT(scene.views[i - 1].name, scene.views[i].name);
  ASSERT_EQ(scene.points.size(), model.points.size());
  size_t num_observations = 0;
  for (const ScenePoint& point : scene.points) {
    for (const Observation& observation : point.observations) {
      const auto px = scene.views[observation.view].Project(point.position);
      ASSERT_TRUE(px);
      EXPECT_LT((*px - observation.px.cast<double>()).norm(), 1e-4);
      ++num_observations;
    }
  }
  EXPECT_EQ(num_observations, 4 * 12);
}

TEST(Scene, RaysMeetThePointsTheyBelongTo) {
  const Scene scene = MakeScene(SmallModel());
  for (const ScenePoint& point : scene.points) {
    for (const View& view : scene.views) {
      const auto px = view.Project(point.position);
      ASSERT_TRUE(px);
      const auto ray = view.RayThrough(*px);
      ASSERT_TRUE(ray);
      EXPECT_NEAR(ray->norm(), 1, 1e-12);
      EXPECT_LT(((point.position - view.Center()).normalized() - *ray).norm(), 1e-12);
    }
  }
}

TEST(Scene, CenterIsWhereTheCameraMapsToItsOrigin) {
  for (const View& view : MakeScene(SmallModel()).views) {
    EXPECT_LT((view.cam_from_world * view.Center()).norm(), 1e-14);
  }
}

TEST(Scene, ContainsTheWholeSensor) {
  const Scene scene = MakeScene(SmallModel());
  const View& view = scene.views[0];
  const double w = static_cast<double>(view.camera.width), h = static_cast<double>(view.camera.height);
  EXPECT_TRUE(view.Contains({0, 0}));
  EXPECT_TRUE(view.Contains({w, h}));
  EXPECT_FALSE(view.Contains({-0.01, 5}));
  EXPECT_FALSE(view.Contains({5, h + 0.01}));
  EXPECT_FALSE(view.Contains({std::nan(""), 5}));
}

TEST(Scene, ZeroedPixelsAreReplacedByProjections) {
  Model model = SmallModel();
  const Scene expected = MakeScene(model);
  for (Image& image : model.images) {
    for (Point2D& point : image.points2d) point.px.setZero();
  }
  const Scene scene = MakeScene(model);
  for (size_t p = 0; p < scene.points.size(); ++p) {
    ASSERT_EQ(scene.points[p].observations.size(), expected.points[p].observations.size());
    for (size_t k = 0; k < scene.points[p].observations.size(); ++k) {
      const Observation &a = scene.points[p].observations[k], &b = expected.points[p].observations[k];
      EXPECT_EQ(a.view, b.view);
      EXPECT_LT((a.px - b.px).norm(), 1e-3f);
    }
  }
}

}  // namespace
}  // namespace glint
