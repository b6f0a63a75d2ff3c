#include "sdf/tile_kernel.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sdf/tile_kernel.cc"
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#include <hwy/foreach_target.h>  // NOLINT: compiles this file once a target
#include <hwy/highway.h>

#include "sdf/tile_frames-inl.h"
#include "sdf/tile_select-inl.h"

HWY_BEFORE_NAMESPACE();
namespace glint::internal::HWY_NAMESPACE {

// Distances of the 16 voxels of a block to its candidates. Sides that are not certain are left to `exact`.
template <bool kWantsClosest>
void ComputeBlock(const Tile& tile, int block, size_t num_candidates, const ExactSide& exact, TileScratch& scratch,
                  TileDistances& out) {
  const D d;
  const size_t lanes = hn::Lanes(d);
  scratch.squared.resize(num_candidates);
  alignas(64) float distance[16];
  alignas(64) uint32_t closest[16];
  uint32_t active = 0, inside = 0, doubtful = 0;  // a bit a voxel
  const float reach = tile.half_width + 2 * kTileRadius;
  const float tolerance = 4e-6f * reach;
  const V infinity = hn::Set(d, kInfinity), margin_least = hn::Set(d, tolerance);
  for (size_t chunk = 0; chunk < 16; chunk += lanes) {
    const V px = hn::Add(hn::Load(d, kLanes.x + chunk), hn::Set(d, kBlocks.x[block]));
    const V py = hn::Add(hn::Load(d, kLanes.y + chunk), hn::Set(d, kBlocks.y[block]));
    const V pz = hn::Add(hn::Load(d, kLanes.z + chunk), hn::Set(d, kBlocks.z[block]));
    V outer = infinity, inner = infinity;  // the closest that see the voxel outside, and inside
    const hn::RebindToUnsigned<D> du;
    [[maybe_unused]] auto closest_index = hn::Zero(du);
    for (size_t i = 0; i < num_candidates; ++i) {
      const uint32_t t = scratch.candidates[i];
      const OfOneTriangle frame{scratch.frames[t / kGroup * kNumCoefficients].lane + t % kGroup};
      V side;
      const V squared = SquaredDistance(frame, px, py, pz, side);
      const V margin = hn::Max(frame[kMargin], margin_least);
      if constexpr (kWantsClosest)
        closest_index = hn::IfThenElse(hn::RebindMask(du, hn::Lt(squared, hn::Min(outer, inner))),
                                       hn::Set(du, static_cast<uint32_t>(i)), closest_index);
      outer = hn::IfThenElse(hn::Ge(side, hn::Neg(margin)), hn::Min(outer, squared), outer);
      inner = hn::IfThenElse(hn::Le(side, margin), hn::Min(inner, squared), inner);
      hn::Store(squared, d, scratch.squared[i].lane + chunk);
    }
    if constexpr (kWantsClosest) hn::Store(closest_index, du, closest + chunk);
    const V outer_distance = hn::Sqrt(outer), inner_distance = hn::Sqrt(inner);
    const V nearest = hn::Min(outer_distance, inner_distance);
    hn::Store(nearest, d, distance + chunk);
    active |= BitsOf(hn::Lt(nearest, hn::Set(d, tile.half_width))) << chunk;
    inside |= BitsOf(hn::Lt(inner, outer)) << chunk;
    doubtful |= BitsOf(hn::Le(hn::Abs(hn::Sub(outer_distance, inner_distance)), hn::Set(d, tolerance))) << chunk;
  }
  if (active == 0) return;
  out.any_active = true;
  const Eigen::Vector3i first(FirstOf(block, 0), FirstOf(block, 1), FirstOf(block, 2));
  if (!tile.is_signed) inside = doubtful = 0;
  for (uint32_t bits = doubtful & active; bits != 0; bits &= bits - 1) {
    const int l = static_cast<int>(hwy::Num0BitsBelowLS1Bit_Nonzero32(bits));
    ++scratch.counters.exact;
    scratch.ties.clear();
    const float limit = (distance[l] + tolerance) * (distance[l] + tolerance);
    for (size_t i = 0; i < num_candidates; ++i)
      if (scratch.squared[i].lane[l] <= limit) scratch.ties.push_back(scratch.tile_ids[scratch.candidates[i]]);
    const Eigen::Vector3i voxel = tile.origin + first + Eigen::Vector3i(l >> 3, l >> 2 & 1, l & 3);
    const bool negative = exact.Inside(voxel, scratch.ties.data(), scratch.ties.size(), scratch.known);
    inside = (inside & ~(1u << l)) | static_cast<uint32_t>(negative) << l;
  }
  for (size_t chunk = 0; chunk < 16; chunk += lanes) {
    const V value = hn::Load(d, distance + chunk);
    hn::Store(hn::IfThenElse(MaskOf(inside >> chunk), hn::Neg(value), value), d, distance + chunk);
  }
  for (int row = 0; row < 4; ++row) {  // four voxels along z each
    const int x = first[0] + (row >> 1), at = (first[1] + (row & 1)) << 3 | first[2];
    std::memcpy(out.distance + (x << 6 | at), distance + ptrdiff_t{4} * row, 4 * sizeof(float));
    out.active[x] |= uint64_t{active >> (4 * row) & 15} << at;
    out.inside[x] |= uint64_t{(active & inside) >> (4 * row) & 15} << at;
    if constexpr (kWantsClosest)
      for (int k = 0; k < 4; ++k)
        out.closest[x << 6 | at | k] = scratch.tile_ids[scratch.candidates[closest[4 * row + k]]];
  }
}

// True if so many triangles are larger than a block that bounding spheres would leave most blocks with all of them.
bool ManyLarge(size_t n, const TileScratch& scratch) {
  size_t large = 0;
  for (size_t i = 0; i < n; ++i) large += scratch.spheres[i / kGroup * 4 + 3].lane[i % kGroup] > 2 * kBlockRadius;
  return 16 * large > n;
}

void ComputeTileImpl(const Tile& tile, const ExactSide& exact, TileScratch& scratch, TileDistances& out) {
  constexpr size_t kCullAbove = 24, kDistancesUpTo = 96;
  std::memset(out.active, 0, sizeof out.active);
  std::memset(out.inside, 0, sizeof out.inside);
  out.any_active = false;
  scratch.known = {};
  ++scratch.counters.tiles;
  size_t n = tile.num_triangles;
  scratch.counters.tile_triangles += n;
  scratch.tile_ids.assign(tile.triangles, tile.triangles + n);
  size_t stride = LoadCorners(tile, scratch);
  if (n > kCullAbove) {
    ComputeSpheres(stride, scratch);
    const float center[3] = {0, 0, 0}, half[3] = {3.5f, 3.5f, 3.5f};
    n = SelectBySpheres(n, stride, center, half, kTileRadius, tile.half_width + kTileRadius, scratch, scratch.kept);
    if (n == 0) return;
    stride = KeepOnly(n, stride, scratch);
    for (size_t i = 0; i < n; ++i) scratch.tile_ids[i] = tile.triangles[scratch.kept[i]];
  }
  scratch.counters.kept_triangles += n;
  ComputeFrames(n, stride, scratch);
  const float reach = tile.half_width + kBlockRadius + 1e-3f;
  const bool by_distances = n <= kDistancesUpTo || ManyLarge(n, scratch);
  const uint32_t blocks = by_distances ? SelectByDistances(n, reach, scratch) : ~0u;
  for (int block = 0; block < kNumBlocks; ++block) {
    if (!(blocks >> block & 1)) continue;
    const float center[3] = {kBlocks.x[block], kBlocks.y[block], kBlocks.z[block]};
    const size_t count =
        by_distances ? ListWanted(n, block, scratch)
                     : SelectBySpheres(n, stride, center, kBlockHalf, kBlockRadius, reach, scratch, scratch.candidates);
    if (count == 0) continue;
    ++scratch.counters.blocks;
    scratch.counters.candidates += count;
    if (tile.wants_closest) {
      ComputeBlock<true>(tile, block, count, exact, scratch, out);
    } else {
      ComputeBlock<false>(tile, block, count, exact, scratch, out);
    }
  }
}

void WriteLeafImpl(const TileDistances& distances, const uint64_t* inside, float scale, float background, float* to) {
  const D d;
  const size_t lanes = hn::Lanes(d);
  const V factor = hn::Set(d, scale), beyond = hn::Set(d, background);
  for (size_t i = 0; i < static_cast<size_t>(kTileVoxels); i += lanes) {
    const auto on = MaskOf(distances.active[i >> 6] >> (i & 63)), negative = MaskOf(inside[i >> 6] >> (i & 63));
    const V value = hn::IfThenElse(on, hn::Mul(hn::Abs(hn::Load(d, distances.distance + i)), factor), beyond);
    hn::StoreU(hn::IfThenElse(negative, hn::Neg(value), value), d, to + i);
  }
}

const char* TargetName() { return hwy::TargetName(HWY_TARGET); }

}  // namespace glint::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace glint::internal {

HWY_EXPORT(ComputeTileImpl);
HWY_EXPORT(TargetName);
HWY_EXPORT(WriteLeafImpl);

void ComputeTile(const Tile& tile, const ExactSide& exact, TileScratch& scratch, TileDistances& out) {
  HWY_DYNAMIC_DISPATCH(ComputeTileImpl)(tile, exact, scratch, out);
}

void WriteLeaf(const TileDistances& distances, const uint64_t* inside, float scale, float background, float* to) {
  HWY_DYNAMIC_DISPATCH(WriteLeafImpl)(distances, inside, scale, background, to);
}

const char* TileKernelTarget() { return HWY_DYNAMIC_DISPATCH(TargetName)(); }

}  // namespace glint::internal
#endif
