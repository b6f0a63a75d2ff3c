#include "highlights/find_lights.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>

#include "highlights/check_lights.h"
#include "highlights/detect.h"
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

SyntheticOptions Small(const std::string& kind, int lights) {
  SyntheticOptions options;
  options.scene = "ellipsoid";
  options.views = 16;
  options.width = 320;
  options.height = 240;
  options.light_kind = kind;
  options.lights = lights;
  return options;
}

class FindLightsOf : public ::testing::TestWithParam<std::pair<const char*, int>> {};

TEST_P(FindLightsOf, TheRightNumberAndKindAndPlace) {
  const Rendered r(Small(GetParam().first, GetParam().second));
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
  EXPECT_TRUE(Contradictions(truth, found, r.scene.views, r.Center()).empty());
}

INSTANTIATE_TEST_SUITE_P(Kinds, FindLightsOf,
                         ::testing::Values(std::pair("distant", 2), std::pair("point", 1), std::pair("flash", 1),
                                           std::pair("camera", 1)),
                         [](const auto& kind) { return kind.param.first; });

TEST(FindLights, NoneOneAndAllOnOneSpotDetermineNothing) {
  const Rendered r(Small("distant", 1));
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

TEST(CheckLights, AWrongGivenLightIsSaid) {
  const Rendered r(Small("distant", 1));
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
  const Rendered r(Small("distant", 1));
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
