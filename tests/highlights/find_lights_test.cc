#include "highlights/find_lights.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <random>

#include "highlights/check_lights.h"
#include "highlights/detect.h"
#include "io/project_images.h"
#include "rendered_scene.h"
#include "synthetic/synthetic_image_source.h"

namespace glint {
namespace {

using ::testing::HasSubstr;

struct Rendered {
  SyntheticImageSource images;
  Scene scene;
  TriangleMesh seed;
  std::vector<Highlight> candidates;

  explicit Rendered(const SyntheticOptions& options)
      : images(SynthesizeScene(options)), scene(MakeScene(images.scene().model)), seed(TrueMesh(images.scene(), 40)) {
    for (size_t v = 0; v < images.size(); ++v) {
      cv::Mat image;
      images.Load(v, image);
      for (const Highlight& h : DetectHighlights(image, cv::Mat(), static_cast<uint32_t>(v), {}))
        candidates.push_back(h);
    }
  }
  std::vector<FoundLight> Find(const std::vector<Highlight>& from, FindLightsSummary* summary = nullptr) const {
    return FindLights(scene, images, seed, {}, {}, from, summary);
  }
  Eigen::Vector3d Center() const { return BoundingBox(seed).center(); }
};

class FindLightsOf : public ::testing::TestWithParam<std::pair<const char*, int>> {};

TEST_P(FindLightsOf, TheRightNumberAndKindAndPlace) {
  const Rendered r(testing::SmallScene(GetParam().first, GetParam().second));
  FindLightsSummary summary;
  std::vector<FoundLight> found = r.Find(r.candidates, &summary);
  std::erase_if(found, [](const FoundLight& f) { return !f.determined; });
  const std::vector<Light>& truth = r.images.scene().lights;
  ASSERT_EQ(found.size(), truth.size()) << summary.BriefReport();
  for (const Light& t : truth) {
    double nearest_deg = 180;
    for (const FoundLight& f : found) {
      EXPECT_EQ(f.light.type, t.type);
      EXPECT_EQ(f.light.frame, t.frame);
      EXPECT_GT(f.light.sigma, 0);
      nearest_deg = std::min(nearest_deg, MeanAngleDeg(f.light, t, r.scene.views, r.Center()));
    }
    EXPECT_LT(nearest_deg, 2);
  }
  EXPECT_EQ(summary.groups.size(), 1u) << summary.BriefReport();
  EXPECT_TRUE(summary.mirror_like.empty()) << summary.mirror_like;
  EXPECT_TRUE(Contradictions(truth, found, r.scene.views, r.Center()).empty());
}

INSTANTIATE_TEST_SUITE_P(Kinds, FindLightsOf,
                         ::testing::Values(std::pair("distant", 2), std::pair("point", 1), std::pair("flash", 1),
                                           std::pair("camera", 1)),
                         [](const auto& kind) { return kind.param.first; });

TEST(FindLights, NoneOneAndAllOnOneSpotDetermineNothing) {
  const Rendered r(testing::SmallScene("distant", 1));
  EXPECT_TRUE(r.Find({}).empty());
  const auto determined = [&](const std::vector<Highlight>& from) {
    const auto found = r.Find(from);
    return std::count_if(found.begin(), found.end(), [](const FoundLight& f) { return f.determined; });
  };
  const auto lit = r.Find(r.candidates);
  ASSERT_EQ(lit.size(), 1u);
  // The strongest of the first view is the lamp's.
  EXPECT_EQ(determined({r.candidates[0]}), 0);
  EXPECT_EQ(determined(std::vector<Highlight>(8, r.candidates[0])), 0);
}

// A chrome object in a room full of bright spots.
std::vector<cv::Mat> InAMirror(const SyntheticScene& scene) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  std::vector<Eigen::Vector3d> spots;
  for (int i = 0; i < 80; ++i)
    spots.push_back(Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized());
  const Scene views = MakeScene(scene.model);
  std::vector<cv::Mat> images;
  for (const View& view : views.views) {
    cv::Mat& image = images.emplace_back(scene.options.height, scene.options.width, CV_8UC3, cv::Scalar::all(20));
    for (int y = 0; y < image.rows; ++y)
      for (int x = 0; x < image.cols; ++x) {
        const auto ray = view.RayThrough({x + 0.5, y + 0.5});
        const auto hit = TraceRay(*scene.shape, view.Center(), *ray, 0, 1e3);
        if (!hit) continue;
        const Eigen::Vector3d mirrored = *ray - 2 * ray->dot(hit->normal) * hit->normal;
        double value = 40;
        for (const Eigen::Vector3d& spot : spots) value += 200 * std::exp(300 * (spot.dot(mirrored) - 1));
        image.at<cv::Vec3b>(y, x) = cv::Vec3b::all(cv::saturate_cast<uint8_t>(value));
      }
  }
  return images;
}

TEST(FindLights, AMirrorOfItsSurroundingsIsSaid) {
  SyntheticOptions options = testing::SmallScene("distant", 1);
  options.views = 8;
  const SyntheticScene scene = SynthesizeScene(options);
  const std::vector<cv::Mat> images = InAMirror(scene);
  FindLightsSummary summary;
  FindLights(MakeScene(scene.model), MemoryImages(images), TrueMesh(scene, 40), {}, {}, testing::Candidates(images),
             &summary);
  EXPECT_THAT(summary.mirror_like, HasSubstr("mirrors its surroundings")) << summary.BriefReport();
}

TEST(FindLights, AnExtendedLampIsSaidWithItsSize) {
  for (const double size_deg : {0.0, 20.0}) {
    SyntheticOptions options = testing::SmallScene("distant", 1);
    options.roughness = size_deg > 0 ? 0.05 : 0.12;
    options.reflectance = size_deg > 0 ? 0.02 : 0.04;  // saturated tops do not say
    options.light_angle_deg = size_deg;
    const Rendered r(options);
    const auto found = r.Find(r.candidates);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_NEAR(found[0].angular_size_deg, size_deg, 7);
    EXPECT_GT(found[0].light.sigma, 0.05 * found[0].angular_size_deg);
  }
}

TEST(CheckLights, AWrongGivenLightIsSaid) {
  const Rendered r(testing::SmallScene("distant", 1));
  const auto found = r.Find(r.candidates);
  const Light truth = r.images.scene().lights[0];
  Light wrong = truth;
  wrong.vector = (truth.vector + 0.3 * truth.vector.unitOrthogonal()).normalized();
  const auto said = Contradictions({wrong}, found, r.scene.views, r.Center());
  ASSERT_EQ(said.size(), 1u);
  EXPECT_THAT(said[0], HasSubstr("seems wrong"));
  Light other = truth;
  other.vector = truth.vector.unitOrthogonal();
  EXPECT_EQ(Contradictions({truth, other}, found, r.scene.views, r.Center()).size(), 1u);
  EXPECT_EQ(Contradictions({other}, found, r.scene.views, r.Center()).size(), 2u);
  EXPECT_TRUE(Contradictions({wrong}, {}, r.scene.views, r.Center()).empty());
}

TEST(CheckLights, ALightInsideTheObject) {
  const Rendered r(testing::SmallScene("distant", 1));
  Light light{LightType::kPoint, LightFrame::kWorld, r.Center(), 0};
  EXPECT_TRUE(InsideObject(light, r.seed));
  light.vector += Eigen::Vector3d(2, 2, 2) * Diagonal(r.seed);
  EXPECT_FALSE(InsideObject(light, r.seed));
  light.frame = LightFrame::kCamera;
  light.vector.setZero();
  EXPECT_FALSE(InsideObject(light, r.seed));
}

}  // namespace
}  // namespace glint
