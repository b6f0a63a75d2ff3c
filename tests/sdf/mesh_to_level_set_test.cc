#include "sdf/mesh_to_level_set.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "core/error.h"
#include "core/parallel.h"
#include "sdf/level_set_impl.h"
#include "sdf/memory_budget.h"
#include "tests/geometry/test_meshes.h"
#include "tests/sdf/brute_force.h"

namespace glint {
namespace {

using testing::Box;
using testing::BruteDistance;
using testing::BruteInside;

struct BandErrors {
  double worst_voxels = 0;  // of the distances
  size_t wrong_signs = 0;   // active or not
  size_t wrong_states = 0;  // active though too far, or not active though near enough
  size_t checked = 0;
};

// Compares voxels all over the mesh's box, and its surroundings, with the truth: as many as take a moment.
BandErrors CompareWithTruth(const TriangleMesh& mesh, const LevelSet& level_set) {
  const openvdb::FloatGrid& grid = *level_set.impl().grid;
  const double h = level_set.voxel_size(), width = level_set.half_width_voxels();
  openvdb::CoordBBox box = grid.evalActiveVoxelBoundingBox();
  box.expand(3);
  std::vector<openvdb::Coord> voxels;
  const double pairs = static_cast<double>(box.volume()) * static_cast<double>(mesh.faces.size());
  const int step = 1 + static_cast<int>(pairs / 4e6);
  int n = 0;
  for (auto it = box.begin(); it; ++it)
    if (n++ % step == 0) voxels.push_back(*it);
  std::vector<BandErrors> parts(voxels.size());
  ParallelFor(voxels.size(), 64, [&](size_t i) {
    const Eigen::Vector3d p = FromVdb(grid.indexToWorld(voxels[i]));
    const double d = BruteDistance(mesh, p) / h;
    const float value = grid.tree().getValue(voxels[i]);
    const bool active = grid.tree().isValueOn(voxels[i]);
    BandErrors& e = parts[i];
    e.checked = 1;
    if (std::abs(d - width) > 1e-4) e.wrong_states = active != (d < width);
    if (active) e.worst_voxels = std::abs(std::abs(value) / h - d);
    if (!active && std::abs(std::abs(value) - grid.background()) > 1e-6 * grid.background()) e.wrong_states = 1;
    if (d > 1e-6) e.wrong_signs = std::signbit(value) != BruteInside(mesh, p);
  });
  BandErrors sum;
  for (const BandErrors& e : parts) {
    sum.worst_voxels = std::max(sum.worst_voxels, e.worst_voxels);
    sum.wrong_signs += e.wrong_signs;
    sum.wrong_states += e.wrong_states;
    sum.checked += e.checked;
  }
  return sum;
}

void ExpectTrue(const TriangleMesh& mesh, double voxel_size, const SdfOptions& options) {
  SdfSummary summary;
  const LevelSet level_set = MeshToLevelSet(mesh, voxel_size, options, &summary);
  const BandErrors errors = CompareWithTruth(mesh, level_set);
  EXPECT_LT(errors.worst_voxels, 2e-5 * (1 + options.half_width_voxels)) << summary.reason;
  EXPECT_EQ(errors.wrong_signs, 0u) << "of " << errors.checked << "; " << summary.reason;
  EXPECT_EQ(errors.wrong_states, 0u);
  EXPECT_GT(errors.checked, 150u);
}

TEST(MeshToLevelSet, BoxHasExactDistances) {
  const LevelSet level_set = MeshToLevelSet(Box({-1, -1, -1}, {1, 1, 1}), 0.1);
  EXPECT_NEAR(level_set.Value({1.1, 0, 0}), 0.1, 1e-6);
  EXPECT_NEAR(level_set.Value({0.9, 0, 0}), -0.1, 1e-6);
  EXPECT_NEAR(level_set.Value({1.1, 1.1, 1.1}), 0.1 * std::sqrt(3.0), 1e-6);
  EXPECT_NEAR(level_set.Value({0, 0, 0}), -0.3, 1e-6);
  EXPECT_NEAR(level_set.Value({3, 0, 0}), 0.3, 1e-6);
}

TEST(MeshToLevelSet, SmoothSphereOfManySizesOfTriangle) {
  for (int subdivisions : {0, 1, 3, 5}) ExpectTrue(testing::Icosphere(subdivisions), 0.05, {});
}

TEST(MeshToLevelSet, AnyHalfWidth) {
  for (double width : {1.0, 1.5, 2.0, 6.5, 15.0}) ExpectTrue(testing::Icosphere(2), 0.08, {.half_width_voxels = width});
}

TEST(MeshToLevelSet, SpikyMeshes) {
  for (unsigned seed = 0; seed < 3; ++seed) {
    ExpectTrue(testing::SpikySphere(2, 0.7, seed), 0.05, {.sign = "pseudonormal"});
    ExpectTrue(testing::SpikySphere(3, 0.4, seed), 0.04, {});
  }
}

TEST(MeshToLevelSet, ManyTrianglesAVoxel) {
  ExpectTrue(testing::SpikySphere(5, 0.01, 1), 0.1, {});
  ExpectTrue(testing::SpikySphere(5, 0.3, 2), 0.08, {.sign = "pseudonormal"});
  ExpectTrue(testing::SpikySphere(4, 0.1, 3), 0.1, {.half_width_voxels = 8});
}

TEST(MeshToLevelSet, LargeAndTinyTrianglesInOneTile) {
  const TriangleMesh plate = Box({-4, -3, -2}, {3, 4, -1.1});
  ExpectTrue(testing::Joined(plate, testing::Icosphere(4)), 0.15, {.half_width_voxels = 4});
}

TEST(MeshToLevelSet, ScalesAndOffsets) {
  for (double scale : {1e-3, 1.0, 1e6})
    for (double offset : {0.0, 1.0, 1e3, 1e6})
      ExpectTrue(
          testing::Transformed(testing::SpikySphere(2, 0.5, 4), scale, scale * offset * Eigen::Vector3d(1, -0.7, 0.3)),
          0.09 * scale, {.half_width_voxels = 2});
}

TEST(MeshToLevelSet, CavityAndTwoBodies) {
  const TriangleMesh outer = testing::Icosphere(3),
                     inner = testing::Transformed(testing::Icosphere(2), 0.5, {0.1, 0, 0});
  const TriangleMesh hollow = testing::Joined(outer, testing::Inverted(inner));
  SdfSummary summary;
  const LevelSet level_set = MeshToLevelSet(hollow, 0.04, {}, &summary);
  EXPECT_EQ(summary.sign, "pseudonormal") << summary.reason;
  ExpectTrue(hollow, 0.04, {});
  ExpectTrue(testing::Joined(outer, testing::Transformed(inner, 1, {3, 0, 0})), 0.05, {});
}

TEST(MeshToLevelSet, InvertedMeshIsTurned) {
  const TriangleMesh sphere = testing::Icosphere(3);
  SdfSummary summary;
  const LevelSet level_set = MeshToLevelSet(testing::Inverted(sphere), 0.05, {}, &summary);
  EXPECT_TRUE(summary.turned);
  EXPECT_LT(level_set.Value({0, 0, 0}), 0);
  MeshToLevelSet(sphere, 0.05, {}, &summary);
  EXPECT_FALSE(summary.turned);
}

TEST(MeshToLevelSet, SoupIsWelded) { ExpectTrue(testing::Soup(testing::SpikySphere(2, 0.5, 1)), 0.05, {}); }

TEST(MeshToLevelSet, AutoFindsNestedAndInvertedComponents) {
  const TriangleMesh a = testing::Icosphere(3), b = testing::Transformed(a, 0.4, {0, 0, 0});
  SdfSummary summary;
  LevelSet level_set = MeshToLevelSet(testing::Joined(a, b), 0.04, {}, &summary);
  EXPECT_EQ(summary.sign, "winding") << summary.reason;
  EXPECT_LT(level_set.Value({0, 0, 0}), 0);
  EXPECT_LT(level_set.Value({0.7, 0, 0}), 0);
  EXPECT_LT(level_set.Value({0.45, 0, 0}), 0);
  // Far from both surfaces pseudo-normals contradict themselves only across the gap.
  level_set =
      MeshToLevelSet(testing::Joined(a, testing::Inverted(testing::Transformed(b, 1, {5, 0, 0}))), 0.04, {}, &summary);
  EXPECT_EQ(summary.sign, "winding") << summary.reason;
}

TEST(MeshToLevelSet, AutoFindsOverlaps) {
  const TriangleMesh a = testing::Icosphere(4), b = testing::Transformed(a, 1, {0.9, 0.2, 0.1});
  const TriangleMesh both = testing::Joined(a, b);
  SdfSummary summary;
  MeshToLevelSet(both, 0.05, {}, &summary);
  EXPECT_EQ(summary.sign, "winding") << summary.reason;
  ExpectTrue(both, 0.05, {});
}

TEST(MeshToLevelSet, HolesAreClosedByTheWindingNumber) {
  TriangleMesh mesh = testing::Icosphere(4);
  const TriangleMesh whole = mesh;
  mesh.faces.erase(mesh.faces.begin() + 100, mesh.faces.begin() + 180);  // a few coherent patches
  SdfSummary summary;
  const LevelSet level_set = MeshToLevelSet(mesh, 0.04, {}, &summary);
  EXPECT_EQ(summary.sign, "winding");
  size_t wrong = 0, checked = 0;
  for (double x = -1.2; x < 1.2; x += 0.04)
    for (double y = -1.2; y < 1.2; y += 0.04)
      for (double z = -1.2; z < 1.2; z += 0.04) {
        const Eigen::Vector3d p(x + 0.001, y, z);
        if (std::abs(p.norm() - 1) < 0.06) continue;
        ++checked;
        wrong += (level_set.Value(p) < 0) != (p.norm() < 1);
      }
  EXPECT_LT(wrong, checked / 500);
}

TEST(MeshToLevelSet, UnsignedIsPositive) {
  const TriangleMesh sphere = testing::Icosphere(3);
  const LevelSet level_set = MeshToLevelSet(sphere, 0.05, {.sign = "unsigned"});
  EXPECT_NEAR(level_set.Value({0.95, 0, 0}), BruteDistance(sphere, {0.95, 0, 0}), 1e-3);
  EXPECT_GT(level_set.Value({0, 0, 0}), 0);
}

TEST(MeshToLevelSet, AnySimilarityTransform) {
  Eigen::Affine3d world_from_index = Eigen::Affine3d::Identity();
  world_from_index.linear() = 0.05 * Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  world_from_index.translation() << 10.3, -4, 2;
  const TriangleMesh mesh = testing::Transformed(testing::SpikySphere(2, 0.5, 9), 1, {10, -4, 2});
  const LevelSet level_set = MeshToLevelSet(mesh, world_from_index);
  EXPECT_NEAR(level_set.voxel_size(), 0.05, 1e-9);
  const BandErrors errors = CompareWithTruth(mesh, level_set);
  EXPECT_LT(errors.worst_voxels, 1e-4);
  EXPECT_EQ(errors.wrong_signs + errors.wrong_states, 0u);
  world_from_index.linear().col(0) *= 2;
  EXPECT_THROW(MeshToLevelSet(mesh, world_from_index), InputError);
}

TEST(MeshToLevelSet, SameAtAnyNumberOfThreads) {
  const TriangleMesh mesh = testing::SpikySphere(4, 0.3, 2);
  for (const char* sign : {"auto", "winding", "unsigned"}) {
    std::vector<float> values[2];
    for (int threads : {1, 2}) {
      const ThreadLimit limit(threads);
      const LevelSet level_set = MeshToLevelSet(mesh, 0.05, {.sign = sign});
      for (auto leaf = level_set.impl().grid->tree().cbeginLeaf(); leaf; ++leaf)
        values[threads - 1].insert(values[threads - 1].end(), leaf->buffer().data(), leaf->buffer().data() + 512);
    }
    ASSERT_EQ(values[0].size(), values[1].size());
    EXPECT_EQ(std::memcmp(values[0].data(), values[1].data(), values[0].size() * sizeof(float)), 0);
  }
}

TEST(MeshToLevelSet, BadInputIsRefused) {
  const TriangleMesh box = Box({0, 0, 0}, {1, 1, 1});
  for (double size : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()})
    EXPECT_THROW(MeshToLevelSet(box, size), InputError) << size;
  EXPECT_THROW(MeshToLevelSet({}, 0.1), InputError);
  EXPECT_THROW(MeshToLevelSet(box, 1e-7), InputError);  // far more memory than there is
  EXPECT_THROW(MeshToLevelSet(box, 1e-300), InputError);
  EXPECT_THROW(MeshToLevelSet(testing::Transformed(box, 1e-6, {0, 0, 0}), 1e-7), InputError);  // OpenVDB cannot
  EXPECT_THROW(MeshToLevelSet(box, 0.001, {.max_memory_gb = 1e-3}), InputError);
  EXPECT_THROW(MeshToLevelSet(box, 0.1, {.half_width_voxels = 0}), InputError);
  EXPECT_THROW(MeshToLevelSet(box, 0.1, {.sign = "guess"}), InputError);
  TriangleMesh bad = box;
  bad.vertices[3][2] = std::nan("");
  EXPECT_THROW(MeshToLevelSet(bad, 0.1), InputError);
  bad = box;
  bad.faces[5][1] = 8;
  EXPECT_THROW(MeshToLevelSet(bad, 0.1), InputError);
  bad.faces[5][1] = -1;
  EXPECT_THROW(MeshToLevelSet(bad, 0.1), InputError);
  // Far from the origin in units of voxels: 32-bit indices end.
  EXPECT_THROW(MeshToLevelSet(testing::Transformed(box, 1, {1e9, 0, 0}), 0.1), InputError);
}

// The memory is said before it is taken, and about right.
TEST(MeshToLevelSet, MemoryIsPredicted) {
  const TriangleMesh sphere = testing::Icosphere(5);
  SdfSummary summary;
  const LevelSet level_set = MeshToLevelSet(sphere, 0.01, {}, &summary);
  const double grid = static_cast<double>(level_set.memory_bytes());
  EXPECT_GT(summary.predicted_bytes, grid);
  EXPECT_LT(summary.predicted_bytes, 3 * grid);
  EXPECT_NEAR(PredictBandBytes(sphere, 3, 0.01), summary.predicted_bytes, 1e-6 * grid);
  EXPECT_THROW(MeshToLevelSet(sphere, 0.01, {.max_memory_gb = 1e-3}), InputError);
  EXPECT_THROW(MeshToLevelSet(sphere, 1e-5, {}), InputError);
}

TEST(LevelSet, MeanValueIsTheMeanOfTheNextVoxels) {
  const LevelSet field = MeshToLevelSet(testing::SpikySphere(3, 0.3, 2), 0.05, {});
  const double h = field.voxel_size();
  for (int n = 0; n < 200; ++n) {
    // Some on the voxels, some between them.
    Eigen::Vector3d x(0.9 * std::sin(n), 0.9 * std::cos(1.7 * n), 0.8 * std::sin(2.3 * n + 1));
    if (n % 2 == 0)
      for (int axis = 0; axis < 3; ++axis) x[axis] = h * std::round(x[axis] / h);
    double sum = 0;
    for (int i = -1; i <= 1; ++i)
      for (int j = -1; j <= 1; ++j)
        for (int k = -1; k <= 1; ++k)
          sum += (2 - std::abs(i)) * (2 - std::abs(j)) * (2 - std::abs(k)) / 64.0 *
                 field.Value(x + h * Eigen::Vector3d(i, j, k));
    EXPECT_NEAR(field.MeanValue(x), sum, 1e-6 * h) << x.transpose();
  }
}

TEST(MeshToLevelSet, OneTriangle) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.faces = {{0, 1, 2}};
  SdfSummary summary;
  const LevelSet level_set = MeshToLevelSet(mesh, 0.1, {}, &summary);
  EXPECT_EQ(summary.sign, "winding");
  EXPECT_NEAR(std::abs(level_set.Value({0.3, 0.3, 0.2})), 0.2, 1e-6);
}

}  // namespace
}  // namespace glint
