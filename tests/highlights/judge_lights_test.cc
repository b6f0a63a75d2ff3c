#include "highlights/judge_lights.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace glint {
namespace {

using ::testing::HasSubstr;

std::vector<double> Widths(double median_deg, double log_sigma, int count) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal(0, log_sigma);
  std::vector<double> widths;
  for (int i = 0; i < count; ++i) widths.push_back(median_deg * std::exp(normal(random)));
  return widths;
}

TEST(NarrowerThanGloss, IsWhatTheScatterOfItsWidthsDoesNotExplain) {
  const std::vector<double> gloss = Widths(6, 0.2, 40);
  EXPECT_FALSE(NarrowerThanGloss(gloss, gloss));
  // All at one place, where the seed is too flat.
  EXPECT_FALSE(NarrowerThanGloss(gloss, Widths(6 * std::exp(-0.2), 0.05, 20)));
  EXPECT_TRUE(NarrowerThanGloss(gloss, Widths(2.5, 0.2, 20)));
  EXPECT_FALSE(NarrowerThanGloss(Widths(6, 0.6, 40), Widths(2.5, 0.2, 20)));  // on a rough seed widths say little
  EXPECT_FALSE(NarrowerThanGloss(gloss, Widths(15, 0.2, 20)));                // an extended lamp
}

TEST(NarrowerThanGloss, NothingIsSaidOfSharpGlossAndOfFew) {
  EXPECT_FALSE(NarrowerThanGloss(Widths(2, 0.2, 40), Widths(0.5, 0.2, 20)));
  EXPECT_FALSE(NarrowerThanGloss(Widths(6, 0.2, 40), {1, 1, 1}));
  EXPECT_FALSE(NarrowerThanGloss({}, {}));
}

FoundLight Supported(double support) {
  FoundLight f;
  f.light = {LightType::kDistant, LightFrame::kWorld, {0, 0, 1}, 1};
  f.support = support;
  f.conditioning = 1;
  f.normal_sigma_deg = 2;
  return f;
}

LightEvidence ExpectedIn(int views) {
  LightEvidence e;
  e.spread_world = 1;
  e.expected_views = views;
  return e;
}

TEST(JudgeLights, ALightShowsAboutAsOftenAsTheOthers) {
  std::vector<FoundLight> lights = {Supported(20), Supported(10)};
  JudgeLights({ExpectedIn(30), ExpectedIn(30)}, 1, {}, lights);
  EXPECT_TRUE(lights[0].determined);
  EXPECT_TRUE(lights[1].determined) << lights[1].why;
  lights = {Supported(30), Supported(10)};
  JudgeLights({ExpectedIn(30), ExpectedIn(30)}, 1, {}, lights);
  EXPECT_FALSE(lights[1].determined);
  EXPECT_THAT(lights[1].why, HasSubstr("30 views should show it"));
  lights = {Supported(10)};
  JudgeLights({ExpectedIn(30)}, 1, {}, lights);
  EXPECT_FALSE(lights[0].determined);
}

TEST(JudgeLights, AnUncertainOneIsNotUsed) {
  std::vector<FoundLight> lights = {Supported(20)};
  lights[0].light.sigma = 30;
  JudgeLights({ExpectedIn(30)}, 1, {}, lights);
  EXPECT_FALSE(lights[0].determined);
  EXPECT_THAT(lights[0].why, HasSubstr("uncertain by 30.0 deg"));
}

TEST(JudgeLights, OneNoDenserThanACrowdOfMarksIsChance) {
  std::vector<FoundLight> lights = {Supported(66), Supported(17), Supported(30)};
  lights[0].normal_sigma_deg = 6;
  lights[1].normal_sigma_deg = 4.2;
  JudgeLights({ExpectedIn(40), ExpectedIn(20), ExpectedIn(40)}, 1, {}, lights);
  EXPECT_FALSE(lights[0].determined);
  EXPECT_FALSE(lights[1].determined);
  EXPECT_THAT(lights[1].why, HasSubstr("by chance"));
  EXPECT_TRUE(lights[2].determined) << lights[2].why;
}

TEST(JudgeLights, GlintsOnAnEdgeAreNoFurtherLight) {
  const auto judged = [](double half_sigma_deg, double off_deg) {
    std::vector<FoundLight> lights = {Supported(20), Supported(12)};
    std::vector<LightEvidence> evidence = {ExpectedIn(25), ExpectedIn(16)};
    evidence[1].half_sigma_deg = half_sigma_deg;
    evidence[1].off_deg.assign(12, {off_deg, 1.0});
    JudgeLights(evidence, 1, {}, lights);
    EXPECT_TRUE(lights[0].determined) << lights[0].why;
    return lights[1];
  };
  EXPECT_FALSE(judged(3, 2).determined);
  EXPECT_THAT(judged(3, 2).why, HasSubstr("another light's"));
  EXPECT_TRUE(judged(0.5, 2).determined);  // a lamp beside the other
  EXPECT_TRUE(judged(3, 20).determined);   // no other light explains it
}

TEST(NotHighlights, MirrorsAndPrintAreToldApart) {
  FoundLight light = Supported(30);
  EXPECT_THAT(NotHighlights({10, 300, 10, 300}, {}), HasSubstr("mirrors its surroundings"));
  EXPECT_THAT(NotHighlights({10, 300, 10, 300}, {light}), HasSubstr("explain 10 %"));
  EXPECT_THAT(NotHighlights({10, 300, 900, 300}, {}), HasSubstr("75 % stay at their place"));
  EXPECT_EQ(NotHighlights({10, 300, 900, 300}, {light}), "");
  EXPECT_EQ(NotHighlights({10, 40, 0, 40}, {}), "");
  light.support = 200;
  EXPECT_EQ(NotHighlights({10, 300, 10, 300}, {light}), "");
}

}  // namespace
}  // namespace glint
