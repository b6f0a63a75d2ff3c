#include "refine/neighbors.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <ctime>
#include <random>
#include <vector>

namespace glint {
namespace {

struct Points {
  std::vector<Eigen::Vector3d> positions, normals;
};

// What SectorNeighbors says it finds, by looking at every target for every query.
std::vector<std::vector<int>> ByLookingAtAll(const Points& queries, const Points& targets,
                                             const NeighborOptions& options) {
  constexpr int kSectors = 6;
  std::vector<std::vector<int>> all;
  for (size_t i = 0; i < queries.positions.size(); ++i) {
    const Eigen::Vector3d& n = queries.normals[i];
    const Eigen::Vector3d u = n.unitOrthogonal(), v = n.cross(u);
    std::vector<std::pair<double, int>> sectors[kSectors];
    for (size_t j = 0; j < targets.positions.size(); ++j) {
      const Eigen::Vector3d chord = targets.positions[j] - queries.positions[i];
      const Eigen::Vector3d mean = (n + targets.normals[j]).normalized();
      if (chord.isZero(0) || n.dot(targets.normals[j]) < std::cos(options.max_normal_angle) ||
          std::abs(mean.dot(chord)) > std::sin(options.max_chord_angle) * chord.norm())
        continue;
      const double turn = (std::atan2(chord.dot(v), chord.dot(u)) + M_PI) / (2 * M_PI);
      sectors[std::min(kSectors - 1, static_cast<int>(turn * kSectors))].emplace_back(chord.squaredNorm(), j);
    }
    std::vector<int>& found = all.emplace_back();
    for (auto& sector : sectors) {
      std::sort(sector.begin(), sector.end());
      for (size_t k = 0; k < std::min<size_t>(sector.size(), (options.count + kSectors - 1) / kSectors); ++k)
        found.push_back(sector[k].second);
    }
    std::sort(found.begin(), found.end());
  }
  return all;
}

// On a long ellipsoid, normals a little off; some of them twice, and some that point in.
Points OnEllipsoid(size_t count, double hole, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  Points points;
  while (points.positions.size() < count) {
    const Eigen::Vector3d direction = Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized();
    if (direction.x() > 1 - hole) continue;
    const Eigen::Array3d axes(3, 1, 0.5);
    Eigen::Vector3d n = (direction.array() / axes).matrix().normalized();
    n += 0.05 * Eigen::Vector3d(normal(random), normal(random), normal(random));
    if (points.positions.size() % 50 == 7) n = -n;
    for (int twice = 0; twice < (points.positions.size() % 31 == 3 ? 2 : 1); ++twice) {
      points.positions.push_back((direction.array() * axes).matrix());
      points.normals.push_back(n.normalized());
    }
  }
  return points;
}

TEST(SectorNeighbors, AreThoseThatLookingAtAllFinds) {
  for (size_t count : {0, 1, 16, 17, 40, 3000})
    for (double hole : {0.0, 0.4}) {
      const Points queries = OnEllipsoid(60, 0, 1), targets = OnEllipsoid(count, hole, 2);
      for (int neighbors : {1, 6, 12}) {
        const NeighborOptions options{.count = neighbors, .max_normal_angle = 0.6, .max_chord_angle = 0.5};
        EXPECT_EQ(SectorNeighbors(queries.positions, queries.normals, targets.positions, targets.normals, options),
                  ByLookingAtAll(queries, targets, options))
            << count << " targets";
      }
    }
}

TEST(SectorNeighbors, OfOneAnother) {
  const Points points = OnEllipsoid(800, 0, 3);
  EXPECT_EQ(SectorNeighbors(points.positions, points.normals, points.positions, points.normals, {}),
            ByLookingAtAll(points, points, {}));
}

TEST(SectorNeighbors, OfAPlaneWithoutThicknessAndOfManyInOnePlace) {
  Points points;
  for (int i = 0; i < 400; ++i) {
    points.positions.push_back({0.1 * (i % 20), i < 200 ? 0.1 * (i / 20) : 0, 0});
    points.normals.push_back({0, 0, i % 3 == 0 ? -1.0 : 1.0});
  }
  EXPECT_EQ(SectorNeighbors(points.positions, points.normals, points.positions, points.normals, {}),
            ByLookingAtAll(points, points, {}));
}

double ProcessorSeconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

// 20,000 highlights, millions of points: most must not be looked at.
TEST(SectorNeighbors, TakeFarLessTimeThanLookingAtAll) {
  const Points queries = OnEllipsoid(2000, 0, 4), few = OnEllipsoid(20, 0, 4), targets = OnEllipsoid(200000, 0, 5);
  double start = ProcessorSeconds();
  const auto found = SectorNeighbors(queries.positions, queries.normals, targets.positions, targets.normals, {});
  const double seconds = ProcessorSeconds() - start;
  start = ProcessorSeconds();
  const auto all = ByLookingAtAll(few, targets, {});
  const double seconds_each = (ProcessorSeconds() - start) / static_cast<double>(few.positions.size());
  EXPECT_LT(seconds, 0.3 * seconds_each * static_cast<double>(queries.positions.size()));
  for (size_t i = 0; i < few.positions.size(); ++i) EXPECT_EQ(found[i], all[i]);
}

}  // namespace
}  // namespace glint
