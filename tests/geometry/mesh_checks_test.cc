#include "geometry/mesh_checks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "tests/geometry/test_meshes.h"

namespace glint {
namespace {

using testing::Box;

size_t Count(const MeshChecks& checks, const std::string& kind) {
  for (const MeshFault& fault : checks.faults)
    if (fault.kind.find(kind) != std::string::npos) return fault.count;
  return 0;
}

// A ring of `segments` × `sides` quads, split.
TriangleMesh Torus(int segments, int sides) {
  TriangleMesh mesh;
  for (int i = 0; i < segments; ++i)
    for (int j = 0; j < sides; ++j) {
      const double u = 2 * M_PI * i / segments, v = 2 * M_PI * j / sides, r = 2 + std::cos(v);
      mesh.vertices.emplace_back(r * std::cos(u), r * std::sin(u), std::sin(v));
      const int a = i * sides + j, b = (i + 1) % segments * sides + j;
      const int c = (i + 1) % segments * sides + (j + 1) % sides, d = i * sides + (j + 1) % sides;
      mesh.faces.insert(mesh.faces.end(), {{a, b, c}, {a, c, d}});
    }
  return mesh;
}

TEST(MeshChecks, SoundMeshesHaveNoFaults) {
  for (const TriangleMesh& mesh : {testing::Icosphere(2), Box({0, 0, 0}, {1, 2, 3}), Torus(12, 8)}) {
    const MeshChecks checks = CheckMeshSoundness(mesh);
    EXPECT_TRUE(checks.sound()) << checks.faults.front().kind;
    EXPECT_TRUE(checks.closed && checks.oriented && checks.manifold);
    EXPECT_EQ(checks.num_components, 1u);
    EXPECT_GT(checks.volume, 0);
  }
  EXPECT_EQ(CheckMeshSoundness(testing::Icosphere(2)).genus, 0);
  EXPECT_EQ(CheckMeshSoundness(Torus(12, 8)).genus, 1);
}

TEST(MeshChecks, SoupIsWelded) {
  const MeshChecks checks = CheckMeshSoundness(testing::Soup(testing::Icosphere(2)));
  EXPECT_TRUE(checks.sound());
  EXPECT_EQ(checks.welded_vertices, 3 * 320u - 162u);
}

TEST(MeshChecks, OpenAndMisoriented) {
  TriangleMesh mesh = Box({0, 0, 0}, {1, 1, 1});
  mesh.faces.pop_back();
  MeshChecks checks = CheckMeshSoundness(mesh);
  EXPECT_FALSE(checks.closed);
  EXPECT_EQ(Count(checks, "boundary"), 3u);
  EXPECT_EQ(checks.genus, -1);
  mesh = Box({0, 0, 0}, {1, 1, 1});
  std::swap(mesh.faces[0][0], mesh.faces[0][1]);
  checks = CheckMeshSoundness(mesh);
  EXPECT_TRUE(checks.closed);
  EXPECT_EQ(Count(checks, "disagree"), 3u);
}

TEST(MeshChecks, NonManifoldDuplicateDegenerate) {
  TriangleMesh mesh = Box({0, 0, 0}, {1, 1, 1});
  mesh.faces.push_back(mesh.faces[0]);
  mesh.faces.push_back({0, 0, 1});
  mesh.vertices.push_back({0.5, 0, 0});
  mesh.faces.push_back({0, 8, 1});
  const MeshChecks checks = CheckMeshSoundness(mesh);
  EXPECT_EQ(Count(checks, "duplicate"), 1u);
  EXPECT_EQ(Count(checks, "without area"), 2u);
  EXPECT_GT(Count(checks, "non-manifold"), 0u);
}

TEST(MeshChecks, SelfIntersections) {
  const TriangleMesh a = testing::Icosphere(2), b = testing::Transformed(a, 1, {0.7, 0.1, 0.05});
  const MeshChecks checks = CheckMeshSoundness(testing::Joined(a, b));
  EXPECT_GT(Count(checks, "pass through"), 20u);
  EXPECT_EQ(CheckMeshSoundness(testing::Joined(a, testing::Transformed(a, 1, {2.1, 0, 0}))).faults.size(), 0u);
}

TEST(MeshChecks, FoldedNeighboursIntersect) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0.3, 1, 0}, {0.6, 0.8, 0}};
  mesh.faces = {{0, 1, 2}, {1, 0, 3}};
  EXPECT_EQ(Count(CheckMeshSoundness(mesh), "pass through"), 1u);
}

TEST(MeshChecks, NestedComponents) {
  const TriangleMesh outer = testing::Icosphere(2), inner = testing::Transformed(outer, 0.5, {0, 0, 0});
  MeshChecks checks = CheckMeshSoundness(testing::Joined(outer, testing::Inverted(inner)));
  EXPECT_TRUE(checks.sound());
  EXPECT_EQ(checks.num_cavities, 1u);
  checks = CheckMeshSoundness(testing::Joined(outer, inner));
  EXPECT_EQ(Count(checks, "inside others"), 1u);
  checks = CheckMeshSoundness(testing::Inverted(outer));
  EXPECT_TRUE(checks.inside_out);
  EXPECT_EQ(Count(checks, "inside out"), 1u);
}

TEST(MeshChecks, TouchingVertex) {
  TriangleMesh mesh = testing::Joined(Box({0, 0, 0}, {1, 1, 1}), Box({1, 1, 1}, {2, 2, 2}));
  const MeshChecks checks = CheckMeshSoundness(mesh, {.self_intersections = false});
  EXPECT_EQ(Count(checks, "touch"), 1u);
  EXPECT_FALSE(checks.manifold);
}

TEST(MeshChecks, BadNumbersAreFaults) {
  TriangleMesh mesh = Box({0, 0, 0}, {1, 1, 1});
  mesh.vertices[7][1] = std::numeric_limits<double>::quiet_NaN();
  mesh.faces[0][0] = 99;
  const MeshChecks checks = CheckMeshSoundness(mesh);
  EXPECT_EQ(Count(checks, "out of range"), 1u);
  EXPECT_GT(Count(checks, "not finite"), 0u);
  EXPECT_TRUE(CheckMeshSoundness({}).faults.empty());
}

}  // namespace
}  // namespace glint
