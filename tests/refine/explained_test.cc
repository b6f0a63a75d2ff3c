#include "refine/explained.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace glint {
namespace {

// What the header says, contact by contact.
double OneByOne(const std::vector<OrientedPoint>& contacts, const Eigen::Vector3d& x, const Eigen::Vector3d& normal) {
  double most = 0;
  for (const OrientedPoint& c : contacts) {
    const double reaches2 = (x - c.position).squaredNorm() / (c.reach * c.reach);
    const double alike = std::clamp((c.normal.dot(normal) - 0.5) / 0.44, 0.0, 1.0);
    if (reaches2 <= 9) most = std::max(most, alike * std::exp(-0.5 * reaches2 * reaches2));
  }
  return most;
}

TEST(Explained, IsTheMostThatAnyContactSays) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> reach(0.02, 0.12);
  const auto direction = [&] { return Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized(); };
  std::vector<OrientedPoint> contacts(3000);
  for (OrientedPoint& c : contacts) {
    c.normal = direction();
    c.position = 0.5 * (c.normal + 0.3 * direction());
    c.reach = reach(random);
  }
  const Explained explained(contacts);
  int partly = 0;
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector3d n = direction(), x = 0.5 * (n + 0.5 * direction());
    const double expected = OneByOne(contacts, x, n);
    ASSERT_NEAR(explained.At(x, n), expected, 1e-8);
    partly += expected > 0.1 && expected < 0.9;
  }
  EXPECT_GT(partly, 200);
}

TEST(Explained, NothingWithoutContactsOrNormals) {
  const std::vector<OrientedPoint> none;
  EXPECT_EQ(Explained(none).At({0, 0, 0}, {0, 0, 1}), 0);
  std::vector<OrientedPoint> one(1);
  one[0].normal = {0, 0, 1};
  one[0].reach = 0.1;
  EXPECT_EQ(Explained(one).At({0, 0, 0}, {0, 0, 0}), 0);
  EXPECT_EQ(Explained(one).At({0, 0, 0}, {0, 0, 1}), 1);
}

}  // namespace
}  // namespace glint
