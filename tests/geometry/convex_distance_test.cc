#include "geometry/convex_distance.h"

#include <gtest/gtest.h>

#include <random>

namespace glint {
namespace {

TEST(NearConvexHull, OfABox) {
  std::vector<Eigen::Vector3d> corners;
  for (int i = 0; i < 8; ++i) corners.emplace_back(i & 1, i >> 1 & 1, i >> 2);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> at(-1, 2);
  int near = 0;
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector3d x(at(random), at(random), at(random));
    const double distance = (x - x.cwiseMax(0.0).cwiseMin(1.0)).norm();
    if (std::abs(distance - 0.2) < 1e-3) continue;
    EXPECT_EQ(NearConvexHull(corners, x, 0.2), distance < 0.2) << x.transpose();
    near += distance < 0.2;
  }
  EXPECT_GT(near, 50);
  EXPECT_LT(near, 500);
}

TEST(NearConvexHull, OfNothingAndOfOnePoint) {
  EXPECT_FALSE(NearConvexHull({}, {0, 0, 0}, 1));
  EXPECT_TRUE(NearConvexHull({{0, 0, 0.5}}, {0, 0, 0}, 1));
  EXPECT_FALSE(NearConvexHull({{0, 0, 2}}, {0, 0, 0}, 1));
}

}  // namespace
}  // namespace glint
