#include "highlights/light_groups.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>

#include "highlights/find_lights.h"
#include "io/project_images.h"
#include "rendered_scene.h"

namespace glint {
namespace {

using ::testing::Each;
using ::testing::HasSubstr;

// A light that shows in most of the views of [first, last).
LightShows ShownIn(size_t num_views, size_t first, size_t last, size_t missing_every = 7) {
  LightShows shows{std::vector<char>(num_views, 1), std::vector<char>(num_views, 0)};
  for (size_t v = first; v < last; ++v) shows.present[v] = v % missing_every != 0;
  return shows;
}

LightGroups Grouped(const std::vector<LightShows>& lights) {
  std::vector<size_t> order(lights.empty() ? 0 : lights[0].expected.size());
  std::iota(order.begin(), order.end(), size_t{0});
  return GroupViewsByLight(lights, order);
}

TEST(LightGroups, NamesAreOrderedByTheirNumbers) {
  EXPECT_EQ(OrderByNumbers({"1.jpg", "10.jpg", "2.jpg", "a/003.jpg", "a/3b.jpg", "a/20.jpg"}),
            (std::vector<size_t>{0, 2, 1, 3, 4, 5}));
}

TEST(LightGroups, OneGroupUnderSteadyLights) {
  const LightGroups groups = Grouped({ShownIn(30, 0, 30), ShownIn(30, 0, 30, 3)});
  EXPECT_EQ(groups.count, 1);
  EXPECT_THAT(groups.shines[0], Each(1));
  EXPECT_EQ(Grouped({}).count, 1);
}

TEST(LightGroups, ALightThatIsOnlyHiddenSomewhereMakesNoGroup) {
  EXPECT_EQ(Grouped({ShownIn(30, 0, 30), ShownIn(30, 0, 17)}).count, 1);
}

TEST(LightGroups, OneLampAfterAnother) {
  const LightGroups groups = Grouped({ShownIn(30, 0, 11), ShownIn(30, 11, 30), ShownIn(30, 0, 30)});
  ASSERT_EQ(groups.count, 2);
  for (size_t v = 0; v < 30; ++v) EXPECT_EQ(groups.group_of_view[v] == groups.group_of_view[0], v < 11) << v;
  const int first = groups.group_of_view[0];
  EXPECT_EQ(groups.shines[first], (std::vector<char>{1, 0, 1}));
  EXPECT_EQ(groups.shines[1 - first], (std::vector<char>{0, 1, 1}));
}

TEST(LightGroups, ThreeGroups) {
  EXPECT_EQ(Grouped({ShownIn(45, 0, 15), ShownIn(45, 15, 30), ShownIn(45, 30, 45)}).count, 3);
}

TEST(LightGroups, FoundFromPhotographs) {
  SyntheticOptions options = testing::SmallScene("distant", 2);
  options.views = 24;
  const SyntheticScene both = SynthesizeScene(options);
  const SyntheticImageSource first(testing::LitByOne(both, 0)), second(testing::LitByOne(both, 1));
  const Scene scene = MakeScene(both.model);
  std::vector<cv::Mat> images(scene.views.size());
  for (size_t v = 0; v < images.size(); ++v) (v < 14 ? first : second).Load(v, images[v]);
  FindLightsSummary summary;
  const auto found =
      FindLights(scene, MemoryImages(images), TrueMesh(both, 40), {}, {}, testing::Candidates(images), &summary);
  EXPECT_THAT(summary.BriefReport(), HasSubstr("light changes between groups"));
  size_t determined = 0;
  for (const FoundLight& f : found) {
    if (!f.determined) continue;
    ++determined;
    const bool is_first = f.light.vector.dot(both.lights[0].vector) > f.light.vector.dot(both.lights[1].vector);
    EXPECT_GT(f.light.vector.dot(both.lights[is_first ? 0 : 1].vector), std::cos(2 * M_PI / 180));
    for (size_t v = 0; v < images.size(); ++v) {
      if (v == 13 || v == 14) continue;
      EXPECT_EQ(ShinesIn(f.light, scene.views[v].name), (v < 14) == is_first) << v;
    }
  }
  EXPECT_EQ(determined, 2u) << summary.BriefReport();
}

}  // namespace
}  // namespace glint
