#include "refine/gaps.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace glint {
namespace {

Eigen::Vector3d Direction(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized();
}

TEST(Gaps, IsTheWayToTheNextPlaceThatFacesAlike) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-0.5, 0.5);
  const auto place = [&] { return Eigen::Vector3d(uniform(random), uniform(random), uniform(random)); };
  std::vector<SurfacePoint> points(300);
  for (SurfacePoint& point : points) {
    point.position = place();
    point.normal = Direction(random);
  }
  std::vector<OrientedPoint> contacts(50), outline(50);
  for (auto* places : {&contacts, &outline})
    for (OrientedPoint& p : *places) {
      p.position = place();
      p.normal = Direction(random);
    }
  const Gaps gaps(points, contacts, outline);
  for (int k = 0; k < 200; ++k) {
    const Eigen::Vector3d x = place(), n = Direction(random);
    double nearest = std::numeric_limits<double>::infinity();
    const auto look = [&](const Eigen::Vector3d& position, const Eigen::Vector3d& normal) {
      const double alike = std::min((n.dot(normal) - 0.5) / 0.44, 1.0);
      if (alike > 0) nearest = std::min(nearest, (position - x).norm() / alike);
    };
    for (const SurfacePoint& p : points) look(p.position, p.normal);
    for (const OrientedPoint& p : contacts) look(p.position, p.normal);
    for (const OrientedPoint& p : outline) look(p.position, p.normal);
    EXPECT_NEAR(gaps.At(x, n, 1), std::min(nearest, 1.0), 1e-12);
    EXPECT_NEAR(gaps.At(x, n, 0.1), std::min(nearest, 0.1), 1e-12);
  }
}

TEST(Gaps, WhatFacesElsewhereOrNowhereIsNoPlace) {
  std::vector<SurfacePoint> points(2);
  points[0].normal = -Eigen::Vector3d::UnitZ();
  const Gaps gaps(points, {}, {});
  EXPECT_EQ(gaps.At({0.01, 0, 0}, Eigen::Vector3d::UnitZ(), 0.1), 0.1);
  EXPECT_NEAR(gaps.At({0.01, 0, 0}, -Eigen::Vector3d::UnitZ(), 0.1), 0.01, 1e-12);
  EXPECT_EQ(Gaps({}, {}, {}).At({0, 0, 0}, Eigen::Vector3d::UnitZ(), 0.1), 0.1);
}

}  // namespace
}  // namespace glint
