#include "seed/spanned_holes.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "geometry/mesh_checks.h"
#include "io/project_images.h"
#include "seed/shape.h"
#include "tests/silhouette/ring_scene.h"

namespace glint {
namespace {

TriangleMesh Pierced(const RingScene& ring, const std::vector<cv::Mat>& masks) {
  const TriangleMesh disc = RingScene::Disc();
  const Silhouettes silhouettes = FindSilhouettes(ring.scene, MemoryImages(std::vector<cv::Mat>(masks.size()), masks),
                                                  {disc, std::vector<int8_t>(ring.scene.points.size(), 1)});
  EXPECT_GT(silhouettes.num_views(), 0u);
  return WithSpannedHoles(silhouettes, disc, 0.02, 0.05);
}

TEST(SpannedHoles, OfARingAreOpened) {
  const RingScene ring;
  const TriangleMesh pierced = Pierced(ring, ring.masks);
  EXPECT_TRUE(CheckMeshSoundness(pierced).sound());
  EXPECT_EQ(GenusOf(pierced), 1);
  double least = 1;
  for (const Eigen::Vector3d& x : pierced.vertices) least = std::min(least, x.head<2>().norm());
  EXPECT_GT(least, 0.5 * (RingScene::kMajor - RingScene::kMinor));
  EXPECT_LT(least, 1.1 * (RingScene::kMajor - RingScene::kMinor));
}

// Where two views alone look through, they are wrong.
TEST(SpannedHoles, OfFewViewsAreNot) {
  const RingScene ring;
  std::vector<cv::Mat> masks = ring.masks;
  for (size_t v = 0; v + 2 < masks.size(); ++v) {
    std::vector<std::vector<cv::Point>> outline;
    cv::findContours(masks[v], outline, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
    cv::drawContours(masks[v], outline, -1, cv::Scalar(255), cv::FILLED);
  }
  EXPECT_EQ(GenusOf(Pierced(ring, masks)), 0);
}

// A dark patch that masks leave out is no hole: it leads nowhere.
TEST(SpannedHoles, OfWhatIsPaintedAreNot) {
  const RingScene ring;
  std::vector<cv::Mat> masks = ring.masks;
  for (size_t v = 0; v < masks.size(); ++v) {
    std::vector<std::vector<cv::Point>> outline;
    cv::findContours(masks[v], outline, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
    cv::drawContours(masks[v], outline, -1, cv::Scalar(255), cv::FILLED);
    const auto px = ring.scene.views[v].Project(Eigen::Vector3d(0, 0, RingScene::kMinor));
    cv::circle(masks[v], {static_cast<int>(px->x()), static_cast<int>(px->y())}, 12, cv::Scalar(0), cv::FILLED);
  }
  EXPECT_EQ(GenusOf(Pierced(ring, masks)), 0);
}

}  // namespace
}  // namespace glint
