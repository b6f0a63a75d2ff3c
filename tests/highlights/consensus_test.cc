#include "highlights/consensus.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace glint {
namespace {

// `right` highlights on a seed whose normals err by sigma, in lobes `width` wide; then `chance` marks anywhere within
// `reach` that are of any width up to twice that.
std::vector<SeenOnSeed> See(int right, double sigma_deg, double width_deg, int chance, double reach_deg) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> even(0, 1);
  std::vector<SeenOnSeed> seen;
  for (int i = 0; i < right; ++i)
    seen.push_back({0, sigma_deg * std::hypot(normal(random), normal(random)), width_deg * (0.8 + 0.4 * even(random))});
  for (int i = 0; i < chance; ++i)
    seen.push_back({0, reach_deg * std::sqrt(even(random)), 2 * width_deg * even(random)});
  return seen;
}

struct Count {
  int right_lost = 0, chance_kept = 0;
};

Count Judge(const std::vector<SeenOnSeed>& seen, size_t right) {
  const std::vector<Unlike> unlike = FindUnlike(seen, 1);
  Count count;
  for (size_t i = 0; i < seen.size(); ++i) {
    const bool kept = unlike[i] == Unlike::kNo;
    count.right_lost += i < right && !kept;
    count.chance_kept += i >= right && kept;
  }
  return count;
}

TEST(Consensus, MarksFarFromTheMirrorPointAreTold) {
  const Count count = Judge(See(40, 2.5, 7, 40, 35), 40);
  EXPECT_LE(count.right_lost, 1);
  EXPECT_LE(count.chance_kept, 5);
}

TEST(Consensus, ARoughSeedLosesNothing) {
  for (const double sigma_deg : {1.0, 3.0, 6.0, 9.0}) EXPECT_LE(Judge(See(60, sigma_deg, 7, 0, 0), 60).right_lost, 1);
}

TEST(Consensus, WhatIsMuchNarrowerThanTheOthersIsNoLobeOfTheirs) {
  std::vector<SeenOnSeed> seen = See(20, 2, 7, 0, 0);
  seen.push_back({0, 1, 2});
  EXPECT_EQ(FindUnlike(seen, 1).back(), Unlike::kWidth);
  for (const double width_deg : {5.0, 15.0}) {
    seen.back().width_deg = width_deg;
    EXPECT_EQ(FindUnlike(seen, 1).back(), Unlike::kNo);
  }
  // Another light may be sharper.
  seen.back() = {1, 1, 2};
  EXPECT_EQ(FindUnlike(seen, 2).back(), Unlike::kNo);
}

TEST(Consensus, FewAreAllKept) {
  std::vector<SeenOnSeed> seen = See(3, 2, 7, 4, 60);
  for (const Unlike unlike : FindUnlike(seen, 1)) EXPECT_EQ(unlike, Unlike::kNo);
  EXPECT_TRUE(FindUnlike({}, 2).empty());
}

}  // namespace
}  // namespace glint
