#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/parallel.h"
#include "geometry/mesh_checks.h"
#include "geometry/point_index.h"
#include "seed/cell_surface.h"
#include "seed/clusters.h"
#include "seed/convex_hull.h"
#include "seed/min_cut.h"
#include "seed/ray_votes.h"
#include "seed/tetrahedra.h"
#include "seed/visibility_cut.h"

namespace glint {
namespace {

std::vector<Eigen::Vector3d> RandomPoints(int count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < count; ++i) points.emplace_back(uniform(random), uniform(random), uniform(random));
  return points;
}

TEST(Tetrahedra, NeighborsAreMutualAndCellsPositive) {
  const Tetrahedra t = DelaunayTetrahedra(RandomPoints(300, 1));
  for (int c = 0; c < static_cast<int>(t.cells.size()); ++c) {
    if (!t.IsInfinite(c)) {
      EXPECT_GT(t.Volume(c), 0);
    }
    for (int k = 0; k < 4; ++k) {
      const auto& back = t.neighbors[t.neighbors[c][k]];
      EXPECT_NE(std::find(back.begin(), back.end(), c), back.end());
    }
  }
}

TEST(Tetrahedra, NoPointLiesInACircumsphere) {
  const std::vector<Eigen::Vector3d> points = RandomPoints(80, 2);
  const Tetrahedra t = DelaunayTetrahedra(points);
  for (int c = 0; c < static_cast<int>(t.cells.size()); ++c) {
    if (t.IsInfinite(c)) continue;
    const Eigen::Vector3d center = t.Circumcenter(c);
    const double radius = (t.Corner(c, 0) - center).norm();
    for (const Eigen::Vector3d& p : points) EXPECT_GT((p - center).norm(), radius * (1 - 1e-9));
  }
}

TEST(Tetrahedra, DuplicatesAndFlatInput) {
  std::vector<Eigen::Vector3d> points = RandomPoints(20, 3);
  points.push_back(points[4]);
  const Tetrahedra t = DelaunayTetrahedra(points);
  EXPECT_EQ(t.vertex_of_point[20], 4);
  EXPECT_EQ(t.cell_of_point[20], -1);
  for (Eigen::Vector3d& p : points) p.z() = 0;
  EXPECT_TRUE(DelaunayTetrahedra(points).cells.empty());
  EXPECT_TRUE(DelaunayTetrahedra({}).cells.empty());
  EXPECT_TRUE(DelaunayTetrahedra({Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitX()}).cells.empty());
}

// Value of the cut that `labels` (1: source side) makes.
int64_t CutValue(const CutGraph& graph, const std::vector<uint8_t>& labels) {
  int64_t value = 0;
  for (size_t i = 0; i < labels.size(); ++i) value += labels[i] ? graph.sink_capacity[i] : graph.source_capacity[i];
  for (const CutGraph::Edge& e : graph.edges) {
    if (labels[e.from] && !labels[e.to]) value += e.forward;
    if (!labels[e.from] && labels[e.to]) value += e.backward;
  }
  return value;
}

TEST(MinCut, IsAsCheapAsTheBestOfAllCuts) {
  std::mt19937 random(7);
  for (int trial = 0; trial < 200; ++trial) {
    const int n = 2 + static_cast<int>(random() % 8);
    CutGraph graph;
    for (int i = 0; i < n; ++i) {
      graph.source_capacity.push_back(random() % 10);
      graph.sink_capacity.push_back(random() % 10);
    }
    for (int i = 0; i < n; ++i)
      for (int j = i + 1; j < n; ++j)
        if (random() % 2)
          graph.edges.push_back({i, j, static_cast<int64_t>(random() % 6), static_cast<int64_t>(random() % 6)});
    int64_t best = CutValue(graph, std::vector<uint8_t>(n, 0));
    for (int bits = 0; bits < (1 << n); ++bits) {
      std::vector<uint8_t> labels(n);
      for (int i = 0; i < n; ++i) labels[i] = (bits >> i) & 1;
      best = std::min(best, CutValue(graph, labels));
    }
    EXPECT_EQ(CutValue(graph, MinCut(graph)), best);
  }
}

TEST(CellSurface, AnyLabelsGiveAClosedOrientedManifold) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const Tetrahedra t = DelaunayTetrahedra(RandomPoints(60, 10 + seed));
    std::mt19937 random(seed);
    std::vector<uint8_t> labels(t.cells.size(), 0);
    double volume = 0;
    for (int c = 0; c < static_cast<int>(labels.size()); ++c)
      if (!t.IsInfinite(c) && random() % 2) {
        labels[c] = 1;
        volume += t.Volume(c);
      }
    const TriangleMesh mesh = CellSurface(t, labels);
    const MeshChecks checks = CheckMeshSoundness(mesh, {.self_intersections = false});
    EXPECT_TRUE(checks.closed);
    EXPECT_TRUE(checks.oriented);
    EXPECT_TRUE(checks.manifold);
    EXPECT_EQ(checks.welded_vertices, 0u);
    EXPECT_NEAR(SignedVolume(mesh), volume, 0.02 * volume);
  }
}

TEST(RayVotes, ASightLineCarvesTheFacetsBeforeItsPoint) {
  // A point in the middle of others: every facet on the way out to the eye gets a vote, and the cell behind a claim.
  std::vector<Eigen::Vector3d> points = RandomPoints(200, 5);
  points.push_back(Eigen::Vector3d(0.01, 0.02, 0.03));
  const Tetrahedra t = DelaunayTetrahedra(points);
  const int point = 200;
  const Eigen::Vector3d eye(5, 4, 3);
  const RayVotes votes = CastVotes(t, {{point, eye}}, std::vector<double>(points.size(), 1e-9), {});
  const RayVotes same = CastVotes(t, {}, std::vector<double>(points.size(), 0), {{points[point], eye}});
  int64_t crossed = 0, crossed_by_free = 0, inside = 0;
  for (int c = 0; c < static_cast<int>(t.cells.size()); ++c)
    for (int k = 0; k < 4; ++k) {
      crossed += votes.facets[c][k];
      crossed_by_free += same.facets[c][k];
      if (votes.facets[c][k] == 0) continue;
      // The facet really meets the line.
      const Eigen::Vector3d a = t.Corner(c, kOutwardFacet[k][0]), b = t.Corner(c, kOutwardFacet[k][1]),
                            d = t.Corner(c, kOutwardFacet[k][2]);
      const Eigen::Vector3d n = (b - a).cross(d - a), ray = eye - points[point];
      const double s = (a - points[point]).dot(n) / ray.dot(n);
      const Eigen::Vector3d x = points[point] + s * ray;
      EXPECT_GT(s, 0);
      EXPECT_GT((b - a).cross(x - a).dot(n), -1e-9);
      EXPECT_GT((d - b).cross(x - b).dot(n), -1e-9);
      EXPECT_GT((a - d).cross(x - d).dot(n), -1e-9);
    }
  EXPECT_GT(crossed, 3 * kVote);
  // The facets that meet in the point itself are on the free line, or not, as rounding has it.
  EXPECT_NEAR(static_cast<double>(crossed), static_cast<double>(crossed_by_free), 3 * kVote);
  for (int c = 0; c < static_cast<int>(t.cells.size()); ++c) {
    inside += votes.inside[c];
    EXPECT_EQ(same.inside[c], 0);
    if (votes.inside[c] > 0) {
      EXPECT_GE(t.CornerOf(c, point), 0);
    }
  }
  EXPECT_EQ(inside, kVote);
}

TEST(RayVotes, AreTheSameForAnyNumberOfThreads) {
  const std::vector<Eigen::Vector3d> points = RandomPoints(300, 6);
  const Tetrahedra t = DelaunayTetrahedra(points);
  std::vector<SightLine> lines;
  std::vector<FreeLine> free_lines;
  for (int i = 0; i < 300; ++i)
    for (int j = 0; j < 5; ++j) {
      const Eigen::Vector3d eye(3 * std::cos(j), 3 * std::sin(j), 2);
      lines.push_back({i, eye});
      free_lines.push_back({1.5 * points[i], eye});
    }
  const std::vector<double> sigma(points.size(), 0.05);
  RayVotes votes[2];
  for (int threads : {1, 2}) {
    const ThreadLimit limit(threads);
    votes[threads - 1] = CastVotes(t, lines, sigma, free_lines);
  }
  EXPECT_EQ(votes[0].facets, votes[1].facets);
  EXPECT_EQ(votes[0].inside, votes[1].inside);
  EXPECT_EQ(votes[0].crossed, votes[1].crossed);
}

TEST(PointIndex, FindsWhatBruteForceFinds) {
  std::vector<Eigen::Vector3d> points = RandomPoints(500, 8);
  points.push_back(points[3]);
  const PointIndex index(points);
  for (const Eigen::Vector3d& x : RandomPoints(50, 9)) {
    std::vector<std::pair<double, int>> all;
    for (size_t i = 0; i < points.size(); ++i) all.emplace_back((points[i] - x).squaredNorm(), static_cast<int>(i));
    std::sort(all.begin(), all.end());
    const std::vector<int> nearest = index.Nearest(x, 7);
    ASSERT_EQ(nearest.size(), 7u);
    for (int k = 0; k < 7; ++k) EXPECT_EQ(nearest[k], all[k].second);
  }
  EXPECT_EQ(PointIndex({}).Nearest(Eigen::Vector3d::Zero(), 3).size(), 0u);
}

// Points on the unit sphere, evenly.
std::vector<Eigen::Vector3d> SpherePoints(int count) {
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (2 * i + 1.0) / count, r = std::sqrt(1 - z * z), a = 2.399963 * i;
    points.emplace_back(r * std::cos(a), r * std::sin(a), z);
  }
  return points;
}

TEST(Clusters, WhatLiesApartIsToldFromWhatIsRare) {
  std::vector<Eigen::Vector3d> points = SpherePoints(400);
  for (int i = 0; i < 9; ++i) points.push_back({3 + 0.05 * (i % 3), 0.05 * i, 0.3});  // a wall behind
  points.push_back({0, 0, 1.2});                                                      // a knob: alone but near
  const std::vector<uint8_t> apart = LieApart(points);
  EXPECT_EQ(std::count(apart.begin(), apart.end(), 1), 9);
  EXPECT_EQ(apart.back(), 0);
  EXPECT_EQ(apart[400], 1);
}

TEST(Clusters, TwoHalvesOfOneObjectStay) {
  std::vector<Eigen::Vector3d> points = SpherePoints(100);
  for (const Eigen::Vector3d& x : SpherePoints(60)) points.push_back(x + Eigen::Vector3d(6, 0, 0));
  const std::vector<uint8_t> apart = LieApart(points);
  EXPECT_EQ(std::count(apart.begin(), apart.end(), 1), 0);
  const std::vector<int> cluster = DenseClusters(points, 2);
  EXPECT_EQ(std::count(cluster.begin(), cluster.end(), 0), 100);
  EXPECT_EQ(*std::max_element(cluster.begin(), cluster.end()), 1);
}

TEST(ConvexHull, OfAGridIsItsCorners) {
  std::vector<Eigen::Vector2d> grid;
  for (int i = 0; i < 5; ++i)
    for (int j = 0; j < 3; ++j) grid.emplace_back(i, j);
  const std::vector<Eigen::Vector2d> hull = ConvexHull(grid);
  EXPECT_EQ(hull.size(), 4u);
  EXPECT_EQ(DistanceToConvex(hull, {2, 1}), 0);
  EXPECT_NEAR(DistanceToConvex(hull, {7, 6}), 5, 1e-12);
  EXPECT_NEAR(DistanceToConvex(ConvexHull({{0, 0}, {2, 0}}), {1, 1}), 1, 1e-12);
  EXPECT_TRUE(std::isinf(DistanceToConvex({}, {1, 1})));
}

}  // namespace
}  // namespace glint
