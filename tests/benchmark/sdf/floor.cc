#include "tests/benchmark/sdf/floor.h"

#include <fmt/format.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/SignedFloodFill.h>
#include <tbb/parallel_for.h>

#include <vector>

#include "sdf/level_set_impl.h"
#include "sdf/mesh_to_level_set.h"
#include "sdf/tile_kernel.h"
#include "tests/benchmark/sdf/measure.h"
#include "tests/benchmark/sdf/meshes.h"

namespace glint::benchmark {

namespace {

using Leaf = openvdb::FloatTree::LeafNodeType;

// CPU nanoseconds an active voxel: writing a constant to leaves that are there, and making them anew in a tree.
void MeasureLeaves(const LevelSet& field) {
  const openvdb::FloatGrid& grid = *field.impl().grid;
  std::vector<const Leaf*> from;
  grid.tree().getNodes(from);
  const double voxels = static_cast<double>(field.num_active_voxels());
  openvdb::FloatGrid::Ptr copy = grid.deepCopy();
  std::vector<Leaf*> to;
  copy->tree().getNodes(to);
  const Cost refill = Measure(
      5,
      [&] {
        tbb::parallel_for(size_t{0}, to.size(), [&](size_t i) {
          float* values = to[i]->buffer().data();
          const auto& mask = from[i]->getValueMask();
          for (openvdb::Index x = 0; x < 8; ++x) {
            const uint64_t word = mask.getWord<uint64_t>(x);
            for (int k = 0; k < 64; ++k) values[x << 6 | static_cast<openvdb::Index>(k)] = word >> k & 1 ? 1.0f : 3.0f;
          }
        });
      },
      [] {});
  openvdb::FloatGrid::Ptr made;
  const Cost make = Measure(
      5,
      [&] {
        made = openvdb::FloatGrid::create(grid.background());
        std::vector<Leaf*> leaves(from.size());
        tbb::parallel_for(size_t{0}, leaves.size(), [&](size_t i) { leaves[i] = new Leaf(*from[i]); });
        for (Leaf* leaf : leaves) made->tree().addLeaf(leaf);
        openvdb::tools::signedFloodFillWithValues(made->tree(), grid.background(), -grid.background(), true, 1, 1);
      },
      [&] { made.reset(); });
  fmt::print("refilling the leaves with a constant   {:6.2f} ns a voxel\n", 1e9 * refill.cpu_s / voxels);
  fmt::print("making the leaves, tree, flood fill    {:6.2f} ns a voxel\n", 1e9 * make.cpu_s / voxels);
}

// CPU nanoseconds of one tile with n triangles of which none can be left out: all are the same.
double TileNanoseconds(size_t n) {
  const std::vector<Eigen::Vector3d> vertices = {{-2, -3, 3}, {9, 0.5, 3.2}, {1, 11, 4}};
  const std::vector<Eigen::Vector3i> faces(n, Eigen::Vector3i(0, 1, 2));
  std::vector<uint32_t> all(n);
  for (size_t i = 0; i < n; ++i) all[i] = static_cast<uint32_t>(i);
  class Nobody : public internal::ExactSide {
    bool Inside(const Eigen::Vector3i&, const uint32_t*, size_t, internal::KnownNormals&) const override {
      return false;
    }
  } nobody;
  const internal::Tile tile{vertices.data(), faces.data(), all.data(), n, Eigen::Vector3i::Zero(), 20, false};
  internal::TileScratch scratch;
  auto distances = std::make_unique<internal::TileDistances>();
  constexpr int kTimes = 2000;
  const Cost cost = Measure(
      5,
      [&] {
        for (int i = 0; i < kTimes; ++i) internal::ComputeTile(tile, nobody, scratch, *distances);
      },
      [] {});
  return 1e9 * cost.cpu_s / kTimes;
}

// Peak bytes of a band at 512 voxels across, beyond the mesh; of the field alone in `field_bytes`.
double PeakBytes(const TriangleMesh& mesh, double* voxels, double* field_bytes) {
  LevelSet field;
  const double h = BoundingBox(mesh).sizes().maxCoeff() / 512;
  const Cost cost = Measure(
      3, [&] { field = MeshToLevelSet(mesh, h); }, [&] { field = LevelSet(); });
  *voxels = static_cast<double>(field.num_active_voxels());
  *field_bytes = static_cast<double>(field.memory_bytes());
  return cost.peak_bytes;
}

// Two meshes of the same shape, so nearly the same voxels: what the one takes more is its triangles'.
void PrintMemory() {
  double voxels, field_bytes, unused;
  const TriangleMesh coarse = MakeMesh("smooth:10000", {}), fine = MakeMesh("smooth:1000000", {});
  const double few = PeakBytes(coarse, &voxels, &field_bytes), many = PeakBytes(fine, &unused, &unused);
  fmt::print(
      "memory: {:.1f} bytes an active voxel at the peak, of which the field keeps {:.1f}; {:.0f} bytes a triangle\n",
      few / voxels, field_bytes / voxels, (many - few) / static_cast<double>(fine.faces.size() - coarse.faces.size()));
}

}  // namespace

void PrintFloor() {
  fmt::print("\nfloor ({})\n", internal::TileKernelTarget());
  const TriangleMesh mesh = MakeMesh("smooth:10000", {});
  MeasureLeaves(MeshToLevelSet(mesh, BoundingBox(mesh).sizes().maxCoeff() / 512));
  fmt::print("the kernel: one voxel, one triangle    {:6.2f} ns\n",
             (TileNanoseconds(24) - TileNanoseconds(8)) / (16.0 * internal::kTileVoxels));
  PrintMemory();
}

}  // namespace glint::benchmark
