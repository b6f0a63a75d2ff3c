#include "sdf/extract_mesh.h"

#include <gtest/gtest.h>
#include <openvdb/tools/SignedFloodFill.h>

#include <cmath>
#include <cstring>

#include "core/error.h"
#include "core/parallel.h"
#include "geometry/edge_topology.h"
#include "sdf/level_set_impl.h"
#include "sdf/mesh_to_level_set.h"
#include "sdf/rebuild.h"
#include "tests/geometry/test_meshes.h"

namespace glint {
namespace {

const Eigen::Vector3d kCenter(0.3, 0.2, 0.1);

// Exact distances to a sphere of `radius` voxels about kCenter, voxels of size 1.
LevelSet SphereField(double radius) {
  const double width = 3;
  openvdb::FloatGrid::Ptr grid = openvdb::FloatGrid::create(static_cast<float>(width));
  auto accessor = grid->getAccessor();
  const int n = static_cast<int>(radius + width) + 2;
  for (int x = -n; x <= n; ++x)
    for (int y = -n; y <= n; ++y)
      for (int z = -n; z <= n; ++z) {
        const double d = (Eigen::Vector3d(x, y, z) - kCenter).norm() - radius;
        if (std::abs(d) < width) accessor.setValue({x, y, z}, static_cast<float>(d));
      }
  openvdb::tools::signedFloodFill(grid->tree());
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  return MakeLevelSet(grid);
}

// The largest distance of a vertex from the sphere.
double WorstVertex(const TriangleMesh& mesh, double radius) {
  double worst = 0;
  for (const Eigen::Vector3d& v : mesh.vertices) worst = std::max(worst, std::abs((v - kCenter).norm() - radius));
  return worst;
}

double WorstVoxel(const LevelSet& level_set, double radius) {
  const openvdb::FloatGrid& grid = *level_set.impl().grid;
  double worst = 0;
  for (auto it = grid.cbeginValueOn(); it; ++it)
    worst = std::max(worst, std::abs((FromVdb(grid.indexToWorld(it.getCoord())) - kCenter).norm() - radius - *it));
  return worst;
}

TEST(ExtractMesh, SphereWithinAThousandthOfAVoxel) {
  const TriangleMesh mesh = ExtractMesh(SphereField(20));
  ASSERT_GT(mesh.faces.size(), 5000u);
  EXPECT_LT(WorstVertex(mesh, 20), 5e-4);
  EXPECT_TRUE(EdgesBalanced(mesh));
  EXPECT_GT(SignedVolume(mesh), 0);
  for (size_t v = 0; v < mesh.vertices.size(); ++v)
    EXPECT_GT(mesh.normals[v].dot((mesh.vertices[v] - kCenter).normalized()), 0.9999);
}

TEST(ExtractMesh, OffsetSurfaces) {
  for (double iso : {-1.5, -0.5, 0.7, 1.8}) {
    const TriangleMesh mesh = ExtractMesh(SphereField(12), iso);
    EXPECT_LT(WorstVertex(mesh, 12 + iso), 0.03) << iso;
    EXPECT_GT(SignedVolume(mesh), 0);
  }
  EXPECT_THROW(ExtractMesh(SphereField(12), 3), InputError);
  EXPECT_THROW(ExtractMesh(SphereField(12), std::nan("")), InputError);
}

TEST(ExtractMesh, FarFromTheOrigin) {
  const TriangleMesh sphere = testing::Transformed(testing::Icosphere(3), 1, {1e6, -1e6, 1e6});
  const TriangleMesh mesh = ExtractMesh(MeshToLevelSet(sphere, 0.05));
  const Eigen::Vector3d center(1e6, -1e6, 1e6);
  for (const Eigen::Vector3d& v : mesh.vertices) EXPECT_NEAR((v - center).norm(), 1, 0.01);
}

TEST(ExtractMesh, SameAtAnyNumberOfThreads) {
  const LevelSet level_set = MeshToLevelSet(testing::SpikySphere(3, 0.3, 5), 0.02);
  TriangleMesh meshes[2];
  for (int threads : {1, 2}) {
    const ThreadLimit limit(threads);
    meshes[threads - 1] = ExtractMesh(level_set);
  }
  ASSERT_EQ(meshes[0].vertices.size(), meshes[1].vertices.size());
  EXPECT_EQ(std::memcmp(meshes[0].vertices.data(), meshes[1].vertices.data(), meshes[0].vertices.size() * 24), 0);
  EXPECT_EQ(meshes[0].faces, meshes[1].faces);
}

TEST(ExtractMesh, EmptyLevelSet) { EXPECT_TRUE(ExtractMesh(LevelSet()).empty()); }

TEST(Redistance, ZeroSetStays) {
  for (double radius : {8.0, 20.0}) {
    LevelSet level_set = SphereField(radius);
    for (int i = 0; i < 5; ++i) level_set = Redistance(level_set, 3);
    EXPECT_LT(WorstVertex(ExtractMesh(level_set), radius), radius < 10 ? 5e-3 : 1e-3) << radius;
    EXPECT_LT(WorstVoxel(level_set, radius), radius < 10 ? 1.5e-2 : 3e-3) << radius;
  }
}

TEST(Redistance, WiderBand) {
  const LevelSet level_set = Redistance(SphereField(15), 6.5);
  EXPECT_NEAR(level_set.half_width_voxels(), 6.5, 1e-5);
  EXPECT_LT(WorstVoxel(level_set, 15), 0.02);
  EXPECT_LT(level_set.Value(kCenter), -6);
}

// A field with the right zero set and wrong distances becomes one of distances.
TEST(Redistance, RestoresDistances) {
  LevelSet level_set = SphereField(15);
  for (auto it = level_set.impl().grid->beginValueOn(); it; ++it) {
    const Eigen::Vector3d x = FromVdb(it.getCoord().asVec3d()) - kCenter;
    it.setValue(static_cast<float>(*it * (0.8 + 0.3 * std::sin(0.2 * x[0]))));
  }
  EXPECT_LT(WorstVoxel(Redistance(level_set, 3), 15), 0.03);
}

TEST(Resample, FinerAndCoarser) {
  for (double size : {0.5, 0.8, 1.7}) {
    const LevelSet level_set = Resample(SphereField(20), size, 3);
    EXPECT_NEAR(level_set.voxel_size(), size, 1e-12);
    EXPECT_LT(WorstVoxel(level_set, 20), 5e-3) << size;
  }
}

TEST(Resample, BadInputIsRefused) {
  EXPECT_THROW(Resample(SphereField(10), 0, 3), InputError);
  EXPECT_THROW(Resample(SphereField(10), std::nan(""), 3), InputError);
  EXPECT_THROW(Resample(SphereField(10), 1, 0.2), InputError);
  EXPECT_THROW(Redistance(LevelSet(), 3), InputError);
}

}  // namespace
}  // namespace glint
