#include "sdf/band.h"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <cmath>

#include "core/cancel_scope.h"

namespace glint::internal {

namespace {

std::unique_ptr<Leaf> MakeLeaf(const Eigen::Vector3i& origin, const TileDistances& distances, const LeafBits& inside,
                               float voxel_size, float background) {
  auto leaf = std::make_unique<Leaf>(openvdb::PartialCreate(), openvdb::Coord(origin[0], origin[1], origin[2]),
                                     background, false);
  leaf->allocate();
  WriteLeaf(distances, inside.data(), voxel_size, background, leaf->buffer().data());
  for (openvdb::Index x = 0; x < 8; ++x) leaf->getValueMask().getWord<uint64_t>(x) = distances.active[x];
  return leaf;
}

// Deactivates voxels further away than the half width, and takes the sides from the distances. False if none is left.
bool DropBeyond(float half_width, TileDistances& distances) {
  uint64_t any = 0;
  for (int x = 0; x < 8; ++x) {
    uint64_t near = 0, inside = 0;
    for (int i = 0; i < 64; ++i) {
      near |= uint64_t{std::abs(distances.distance[x << 6 | i]) < half_width} << i;
      inside |= uint64_t{std::signbit(distances.distance[x << 6 | i])} << i;
    }
    distances.active[x] &= near;
    distances.inside[x] = distances.active[x] & inside;
    any |= distances.active[x];
  }
  return any != 0;
}

std::vector<uint32_t> ClosestOfActive(const TileDistances& distances) {
  std::vector<uint32_t> closest;
  for (int i = 0; i < kTileVoxels; ++i)
    if (distances.active[i >> 6] >> (i & 63) & 1) closest.push_back(distances.closest[i]);
  return closest;
}

void Add(TileCounters& sum, const TileCounters& c) {
  sum.tiles += c.tiles;
  sum.tile_triangles += c.tile_triangles;
  sum.kept_triangles += c.kept_triangles;
  sum.blocks += c.blocks;
  sum.candidates += c.candidates;
  sum.exact += c.exact;
}

class NoSide : public ExactSide {
 public:
  bool Inside(const Eigen::Vector3i&, const uint32_t*, size_t, KnownNormals&) const override { return false; }
};

}  // namespace

std::vector<std::unique_ptr<Leaf>> ComputeLeaves(const TriangleMesh& mesh, const TileBins& bins,
                                                 const BandOptions& options, TileCounters* counters,
                                                 std::vector<std::vector<uint32_t>>* closest) {
  const float background = static_cast<float>(options.half_width_voxels * options.voxel_size);
  const NoSide no_side;
  std::vector<std::unique_ptr<Leaf>> leaves(bins.size());
  if (closest) closest->assign(bins.size(), {});
  tbb::enumerable_thread_specific<TileScratch> scratches;
  const Progress& asked = CancelScope::Current();
  tbb::parallel_for(tbb::blocked_range<size_t>(0, bins.size(), 16), [&](const auto& range) {
    asked.ThrowIfCancelled();
    TileScratch& scratch = scratches.local();
    TileDistances distances{};
    for (size_t i = range.begin(); i != range.end(); ++i) {
      const Tile tile{mesh.vertices.data(),
                      mesh.faces.data(),
                      bins.triangles.data() + bins.first[i],
                      bins.first[i + 1] - bins.first[i],
                      bins.origin[i],
                      static_cast<float>(options.half_width_voxels + options.correction_reach),
                      options.exact != nullptr,
                      options.correction != nullptr || closest != nullptr};
      ComputeTile(tile, options.exact ? *options.exact : no_side, scratch, distances);
      if (!distances.any_active) continue;
      if (options.correction) {
        options.correction->Correct(tile.origin, distances);
        if (!DropBeyond(static_cast<float>(options.half_width_voxels), distances)) continue;
      }
      if (closest) (*closest)[i] = ClosestOfActive(distances);
      const LeafBits inside = options.signer ? options.signer->Inside(tile.origin, distances) : LeafBits{};
      leaves[i] = MakeLeaf(tile.origin, distances, inside, static_cast<float>(options.voxel_size), background);
    }
  });
  if (counters)
    for (const TileScratch& scratch : scratches) Add(*counters, scratch.counters);
  return leaves;
}

}  // namespace glint::internal
