#include "sdf/band.h"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <cmath>

namespace glint::internal {

namespace {

std::unique_ptr<Leaf> MakeLeaf(const Eigen::Vector3i& origin, const TileDistances& distances, const LeafBits& inside,
                               float voxel_size, float background) {
  auto leaf = std::make_unique<Leaf>(openvdb::PartialCreate(), openvdb::Coord(origin[0], origin[1], origin[2]),
                                     background, false);
  leaf->allocate();
  float* to = leaf->buffer().data();
  for (int x = 0; x < 8; ++x) {
    const uint64_t active = distances.active[x], negative = inside[x];
    for (int i = 0; i < 64; ++i) {
      const float value = (active >> i & 1) ? std::abs(distances.distance[x << 6 | i]) * voxel_size : background;
      to[x << 6 | i] = (negative >> i & 1) ? -value : value;
    }
    leaf->getValueMask().getWord<uint64_t>(x) = active;
  }
  return leaf;
}

// Deactivates voxels further away than the half width. False if none is left.
bool DropBeyond(float half_width, TileDistances& distances) {
  uint64_t any = 0;
  for (int x = 0; x < 8; ++x) {
    for (int i = 0; i < 64; ++i)
      if (!(std::abs(distances.distance[x << 6 | i]) < half_width)) distances.active[x] &= ~(uint64_t{1} << i);
    any |= distances.active[x];
  }
  return any != 0;
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
  bool Inside(const Eigen::Vector3i&, const uint32_t*, size_t) const override { return false; }
};

}  // namespace

std::vector<std::unique_ptr<Leaf>> ComputeLeaves(const TriangleMesh& mesh, const TileBins& bins,
                                                 const BandOptions& options, TileCounters* counters) {
  const float background = static_cast<float>(options.half_width_voxels * options.voxel_size);
  const NoSide no_side;
  std::vector<std::unique_ptr<Leaf>> leaves(bins.size());
  tbb::enumerable_thread_specific<TileScratch> scratches;
  tbb::parallel_for(tbb::blocked_range<size_t>(0, bins.size(), 16), [&](const auto& range) {
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
                      options.correction != nullptr};
      ComputeTile(tile, options.exact ? *options.exact : no_side, scratch, distances);
      if (!distances.any_active) continue;
      if (options.correction) {
        options.correction->Correct(tile.origin, distances);
        if (!DropBeyond(static_cast<float>(options.half_width_voxels), distances)) continue;
      }
      const LeafBits inside = options.signer ? options.signer->Inside(tile.origin, distances) : LeafBits{};
      leaves[i] = MakeLeaf(tile.origin, distances, inside, static_cast<float>(options.voxel_size), background);
    }
  });
  if (counters)
    for (const TileScratch& scratch : scratches) Add(*counters, scratch.counters);
  return leaves;
}

}  // namespace glint::internal
