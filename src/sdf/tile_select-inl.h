// Which triangles of a tile may be closest to some voxel of it, or of one of its blocks. Included by tile_kernel.cc for
// each target.
#if defined(GLINT_SDF_TILE_SELECT_INL_H) == defined(HWY_TARGET_TOGGLE)  // once a target
#ifdef GLINT_SDF_TILE_SELECT_INL_H
#undef GLINT_SDF_TILE_SELECT_INL_H
#else
#define GLINT_SDF_TILE_SELECT_INL_H
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "geometry/closest_point.h"
#include "sdf/tile_frames-inl.h"
#include "sdf/tile_kernel.h"

// Once a target, each in a namespace of its own.
// NOLINTBEGIN(misc-definitions-in-headers)
HWY_BEFORE_NAMESPACE();
namespace glint::internal::HWY_NAMESPACE {

// Bounding spheres of the triangles, in single precision with room for its rounding.
void ComputeSpheres(size_t stride, TileScratch& scratch) {
  scratch.spheres.resize(stride / kGroup * 4);
  const double* from = scratch.corners.data();
  for (size_t i = 0; i < stride; ++i) {
    double center[3], squared[3] = {0, 0, 0};
    for (int axis = 0; axis < 3; ++axis) {
      const double a = from[axis * stride + i], b = from[(3 + axis) * stride + i], c = from[(6 + axis) * stride + i];
      const double m = center[axis] = (a + b + c) / 3;
      squared[0] += (a - m) * (a - m), squared[1] += (b - m) * (b - m), squared[2] += (c - m) * (c - m);
    }
    Pack* to = scratch.spheres.data() + i / kGroup * 4;
    for (int axis = 0; axis < 3; ++axis) to[axis].lane[i % kGroup] = static_cast<float>(center[axis]);
    const double size = std::abs(center[0]) + std::abs(center[1]) + std::abs(center[2]);
    const double radius = std::sqrt(std::max({squared[0], squared[1], squared[2]}));
    to[3].lane[i % kGroup] = static_cast<float>(radius * (1 + 1e-6) + 1e-6 * size + 1e-6);
  }
}

Eigen::Vector3d Corner(const TileScratch& scratch, size_t stride, size_t i, int k) {
  const double* from = scratch.corners.data() + i;
  const size_t x = size_t{3} * k;
  return {from[x * stride], from[(x + 1) * stride], from[(x + 2) * stride]};
}

// Of the first n triangles, those that may be closest to some point of the box about `center` with half sizes `half`,
// by their bounding spheres: x on a triangle is never closest if for a point q of the surface all points p of the box
// have ‖p − x‖² − ‖p − q‖² = ‖x − c‖² − ‖q − c‖² − 2 (p − c)·(x − q) > 0. Nothing if none lies within `reach` of the
// centre.
size_t SelectBySpheres(size_t n, size_t stride, const float center[3], const float half[3], float radius, float reach,
                       const TileScratch& scratch, std::vector<uint32_t>& selected) {
  const D d;
  const hn::RebindToUnsigned<D> du;
  const size_t lanes = hn::Lanes(d), padded = RoundUp(n);
  const Pack* spheres = scratch.spheres.data();
  const V cx = hn::Set(d, center[0]), cy = hn::Set(d, center[1]), cz = hn::Set(d, center[2]);
  const auto sphere = [&](size_t i, int k) { return hn::Load(d, spheres[i / kGroup * 4 + k].lane + i % kGroup); };
  V nearest = hn::Set(d, kInfinity), lowest = nearest;
  auto nearest_index = hn::Zero(du);
  for (size_t i = 0; i < padded; i += lanes) {
    const V x = hn::Sub(sphere(i, 0), cx), y = hn::Sub(sphere(i, 1), cy), z = hn::Sub(sphere(i, 2), cz);
    const V squared = hn::MulAdd(x, x, hn::MulAdd(y, y, hn::Mul(z, z)));
    const V distance = hn::Sqrt(squared), r = sphere(i, 3);
    const V upper = hn::Add(distance, r);
    lowest = hn::Min(lowest, hn::Sub(distance, r));
    const auto closer = hn::Lt(upper, nearest);
    nearest = hn::Min(nearest, upper);
    nearest_index = hn::IfThenElse(hn::RebindMask(du, closer), hn::Iota(du, static_cast<uint32_t>(i)), nearest_index);
  }
  if (hn::GetLane(hn::MinOfLanes(d, lowest)) > reach) return 0;
  alignas(64) float values[16];
  alignas(64) uint32_t indices[16];
  hn::Store(nearest, d, values);
  hn::Store(nearest_index, du, indices);
  size_t best = 0;
  for (size_t l = 1; l < lanes; ++l)
    if (values[l] < values[best] || (values[l] == values[best] && indices[l] < indices[best])) best = l;
  const size_t seed = std::min<size_t>(indices[best], n - 1);
  const Eigen::Vector3d c(center[0], center[1], center[2]);
  const TrianglePoint at = ClosestOnTriangle(Corner(scratch, stride, seed, 0), Corner(scratch, stride, seed, 1),
                                             Corner(scratch, stride, seed, 2), c);
  const V qx = hn::Set(d, static_cast<float>(at.point[0])), qy = hn::Set(d, static_cast<float>(at.point[1])),
          qz = hn::Set(d, static_cast<float>(at.point[2]));
  const V limit = hn::Set(d, static_cast<float>(at.squared_distance) * 1.00001f + 1e-3f);
  const V hx = hn::Set(d, 2 * half[0]), hy = hn::Set(d, 2 * half[1]), hz = hn::Set(d, 2 * half[2]);
  const V twice_radius = hn::Set(d, 2.0001f * radius), reaches = hn::Set(d, reach), zero = hn::Zero(d);
  selected.resize(padded + kGroup);
  size_t count = 0;
  for (size_t i = 0; i < padded; i += lanes) {
    const V sx = sphere(i, 0), sy = sphere(i, 1), sz = sphere(i, 2), r = sphere(i, 3);
    const V x = hn::Sub(sx, cx), y = hn::Sub(sy, cy), z = hn::Sub(sz, cz);
    const V distance = hn::Sqrt(hn::MulAdd(x, x, hn::MulAdd(y, y, hn::Mul(z, z))));
    const V lower = hn::Max(hn::Sub(distance, r), zero);
    V right = hn::MulAdd(twice_radius, r, limit);
    right = hn::MulAdd(hx, hn::Abs(hn::Sub(sx, qx)), right);
    right = hn::MulAdd(hy, hn::Abs(hn::Sub(sy, qy)), right);
    right = hn::MulAdd(hz, hn::Abs(hn::Sub(sz, qz)), right);
    auto keep = hn::And(hn::Le(hn::Mul(lower, lower), right), hn::Le(lower, reaches));
    if (i + lanes > n) keep = hn::And(keep, hn::FirstN(d, n > i ? n - i : 0));
    count += hn::CompressStore(hn::Iota(du, static_cast<uint32_t>(i)), hn::RebindMask(du, keep), du,
                               selected.data() + count);
  }
  return count;
}

// The bits of a mask, the first lane lowest.
template <class M>
HWY_INLINE uint32_t BitsOf(M mask) {
  const D d;
  alignas(8) uint8_t bytes[8] = {};
  hn::StoreMaskBits(d, mask, bytes);
  return (static_cast<uint32_t>(bytes[0]) | static_cast<uint32_t>(bytes[1]) << 8) & ((1u << hn::Lanes(d)) - 1);
}

// And back, from the lowest bits.
HWY_INLINE auto MaskOf(uint64_t bits) {
  alignas(8) uint8_t bytes[8] = {static_cast<uint8_t>(bits), static_cast<uint8_t>(bits >> 8)};
  return hn::LoadMaskBits(D(), bytes);
}

// The same for all blocks at once by the distances of their centres: bit b of scratch.wanted[i] tells whether block b
// needs triangle i, which is not further from its centre than the closest one and the block's diameter. Gives the
// blocks that come within reach.
uint32_t SelectByDistances(size_t n, float reach, TileScratch& scratch) {
  const D d;
  const size_t lanes = hn::Lanes(d);
  scratch.center_distance.resize(2 * n);
  scratch.wanted.assign(n, 0);
  uint32_t blocks = 0;
  for (size_t chunk = 0; chunk < kNumBlocks; chunk += lanes) {
    const V x = hn::Load(d, kBlocks.x + chunk), y = hn::Load(d, kBlocks.y + chunk), z = hn::Load(d, kBlocks.z + chunk);
    V lowest = hn::Set(d, kInfinity);
    for (size_t i = 0; i < n; ++i) {
      const OfOneTriangle frame{scratch.frames[i / kGroup * kNumCoefficients].lane + i % kGroup};
      V side;
      const V distance = hn::Sqrt(SquaredDistance(frame, x, y, z, side));
      hn::Store(distance, d, scratch.center_distance[2 * i + chunk / kGroup].lane + chunk % kGroup);
      lowest = hn::Min(lowest, distance);
    }
    const auto near = hn::Le(lowest, hn::Set(d, reach));
    blocks |= BitsOf(near) << chunk;
    const V limit = hn::IfThenElse(near, hn::MulAdd(lowest, hn::Set(d, 1.00001f), hn::Set(d, 2 * kBlockRadius + 1e-3f)),
                                   hn::Set(d, -1.0f));
    for (size_t i = 0; i < n; ++i) {
      const V distance = hn::Load(d, scratch.center_distance[2 * i + chunk / kGroup].lane + chunk % kGroup);
      scratch.wanted[i] |= BitsOf(hn::Le(distance, limit)) << chunk;
    }
  }
  return blocks;
}

// The triangles that block b needs.
size_t ListWanted(size_t n, int block, TileScratch& scratch) {
  scratch.candidates.resize(n);
  size_t count = 0;
  for (size_t i = 0; i < n; ++i) {
    scratch.candidates[count] = static_cast<uint32_t>(i);
    count += scratch.wanted[i] >> block & 1;
  }
  return count;
}

// Keeps the triangles scratch.kept[0 .. count) of the corners and spheres.
size_t KeepOnly(size_t count, size_t stride, TileScratch& scratch) {
  const size_t new_stride = RoundUp(count);
  const auto source = [&](size_t i) { return scratch.kept[std::min(i, count - 1)]; };
  for (int k = 0; k < 9; ++k)  // in place: entries only move down
    for (size_t i = 0; i < new_stride; ++i)
      scratch.corners[k * new_stride + i] = scratch.corners[k * stride + source(i)];
  for (size_t i = 0; i < new_stride; ++i)
    for (int k = 0; k < 4; ++k)
      scratch.spheres[i / kGroup * 4 + k].lane[i % kGroup] =
          scratch.spheres[source(i) / kGroup * 4 + k].lane[source(i) % kGroup];
  return new_stride;
}

}  // namespace glint::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
// NOLINTEND(misc-definitions-in-headers)

#endif  // GLINT_SDF_TILE_SELECT_INL_H
