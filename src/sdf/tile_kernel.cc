#include "sdf/tile_kernel.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "geometry/closest_point.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sdf/tile_kernel.cc"
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#include <hwy/foreach_target.h>  // NOLINT: compiles this file once a target
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace glint::internal::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using D = hn::CappedTag<float, 16>;
using V = hn::Vec<D>;
using Half = hn::CappedTag<double, 8>;  // as many bytes as D, half the lanes

constexpr size_t kGroup = 16;
constexpr float kInfinity = std::numeric_limits<float>::infinity();

// Coefficients of a triangle abc about the tile's centre: its unit normal and plane offset; unit vectors ex along ab
// and ey = n × ex; then, in the plane with the foot of the centre as origin, for each edge its outward normal, offset
// and the interval that it covers along itself; last the distance from the plane under which its side is not certain.
enum Coefficient {
  kNx,
  kNy,
  kNz,
  kS,
  kXx,
  kXy,
  kXz,
  kYx,
  kYy,
  kYz,
  kY0,
  kLow0,
  kHigh0,
  kU1x,
  kU1y,
  kK1,
  kLow1,
  kHigh1,
  kU2x,
  kU2y,
  kK2,
  kLow2,
  kHigh2,
  kMargin,
  kNumCoefficients
};

// Reads coefficients of one triangle for all lanes, or of as many triangles as there are lanes.
struct OfOneTriangle {
  const float* at;
  HWY_INLINE V operator[](int k) const { return hn::Set(D(), at[k * kGroup]); }
};
struct OfManyTriangles {
  const float* at;
  HWY_INLINE V operator[](int k) const { return hn::Load(D(), at + k * kGroup); }
};

// Squared distance of p from the triangle, and the signed distance from its plane.
template <class Coefficients>
HWY_INLINE V SquaredDistance(const Coefficients& c, V px, V py, V pz, V& side) {
  const D d;
  const V zero = hn::Zero(d), infinity = hn::Set(d, kInfinity);
  side = hn::MulAdd(c[kNx], px, hn::MulAdd(c[kNy], py, hn::MulAdd(c[kNz], pz, c[kS])));
  const V x = hn::MulAdd(c[kXx], px, hn::MulAdd(c[kXy], py, hn::Mul(c[kXz], pz)));
  const V y = hn::MulAdd(c[kYx], px, hn::MulAdd(c[kYy], py, hn::Mul(c[kYz], pz)));
  // How far outside of each edge, and how far past its ends.
  const V out0 = hn::Sub(hn::Neg(y), c[kY0]);
  const V past0 = hn::Max(hn::Max(hn::Sub(c[kLow0], x), hn::Sub(x, c[kHigh0])), zero);
  const V u1x = c[kU1x], u1y = c[kU1y], u2x = c[kU2x], u2y = c[kU2y];
  const V out1 = hn::MulAdd(u1y, x, hn::NegMulAdd(u1x, y, c[kK1]));
  const V along1 = hn::MulAdd(u1x, x, hn::Mul(u1y, y));
  const V past1 = hn::Max(hn::Max(hn::Sub(c[kLow1], along1), hn::Sub(along1, c[kHigh1])), zero);
  const V out2 = hn::MulAdd(u2y, x, hn::NegMulAdd(u2x, y, c[kK2]));
  const V along2 = hn::MulAdd(u2x, x, hn::Mul(u2y, y));
  const V past2 = hn::Max(hn::Max(hn::Sub(c[kLow2], along2), hn::Sub(along2, c[kHigh2])), zero);
  // In the plane the closest boundary point lies on an edge that p is outside of.
  const V d0 = hn::IfThenElse(hn::Ge(out0, zero), hn::MulAdd(out0, out0, hn::Mul(past0, past0)), infinity);
  const V d1 = hn::IfThenElse(hn::Ge(out1, zero), hn::MulAdd(out1, out1, hn::Mul(past1, past1)), infinity);
  const V d2 = hn::IfThenElse(hn::Ge(out2, zero), hn::MulAdd(out2, out2, hn::Mul(past2, past2)), infinity);
  const V boundary = hn::Min(d0, hn::Min(d1, d2));
  const V in_plane = hn::IfThenElse(hn::Lt(boundary, infinity), boundary, zero);
  return hn::MulAdd(side, side, in_plane);
}

// Where the voxels of a block of 2 × 2 × 4 lie about its centre. The block's first voxel is the first lane.
struct alignas(64) LaneOffsets {
  float x[16], y[16], z[16];
  constexpr LaneOffsets() : x(), y(), z() {
    for (int l = 0; l < 16; ++l) {
      x[l] = (l >> 3) - 0.5f;
      y[l] = (l >> 2 & 1) - 0.5f;
      z[l] = (l & 3) - 1.5f;
    }
  }
};
constexpr LaneOffsets kLanes;
constexpr float kBlockHalf[3] = {0.5f, 0.5f, 1.5f};
constexpr float kBlockRadius = 1.6583124f;  // of the voxel centres about the block's
constexpr float kTileRadius = 6.0621778f;

size_t RoundUp(size_t n) { return (n + kGroup - 1) / kGroup * kGroup; }

// Corners about the tile's centre, in double: nine arrays of `stride` entries; the last group is filled up by copies.
size_t LoadCorners(const Tile& tile, TileScratch& scratch) {
  const size_t n = tile.num_triangles, stride = RoundUp(n);
  scratch.corners.resize(9 * stride);
  double* to = scratch.corners.data();
  const double cx = tile.origin[0] + 3.5, cy = tile.origin[1] + 3.5, cz = tile.origin[2] + 3.5;
  for (size_t i = 0; i < stride; ++i) {
    const Eigen::Vector3i& face = tile.faces[tile.triangles[std::min(i, n - 1)]];
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d& v = tile.vertices[face[k]];
      to[(3 * k + 0) * stride + i] = v[0] - cx;
      to[(3 * k + 1) * stride + i] = v[1] - cy;
      to[(3 * k + 2) * stride + i] = v[2] - cz;
    }
  }
  return stride;
}

// Works out the frames of all triangles.
void ComputeFrames(size_t stride, TileScratch& scratch) {
  const Half d;
  const hn::Rebind<float, Half> df;
  using VD = hn::Vec<Half>;
  const size_t lanes = hn::Lanes(d);
  scratch.frames.resize(stride / kGroup * kNumCoefficients);
  const double* from = scratch.corners.data();
  const VD zero = hn::Zero(d), one = hn::Set(d, 1.0);
  for (size_t i = 0; i < stride; i += lanes) {
    const auto corner = [&](int k, int axis) { return hn::LoadU(d, from + (3 * k + axis) * stride + i); };
    float* to = scratch.frames[i / kGroup * kNumCoefficients].lane + i % kGroup;
    const auto store = [&](int k, VD v) { hn::StoreU(hn::DemoteTo(df, v), df, to + k * kGroup); };
    const VD ax = corner(0, 0), ay = corner(0, 1), az = corner(0, 2);
    const VD ux = hn::Sub(corner(1, 0), ax), uy = hn::Sub(corner(1, 1), ay), uz = hn::Sub(corner(1, 2), az);
    const VD vx = hn::Sub(corner(2, 0), ax), vy = hn::Sub(corner(2, 1), ay), vz = hn::Sub(corner(2, 2), az);
    const auto dot = [](VD px, VD py, VD pz, VD qx, VD qy, VD qz) {
      return hn::MulAdd(px, qx, hn::MulAdd(py, qy, hn::Mul(pz, qz)));
    };
    const VD uu = dot(ux, uy, uz, ux, uy, uz), vv = dot(vx, vy, vz, vx, vy, vz);
    const VD length0 = hn::Sqrt(uu), inverse0 = hn::Div(one, length0);
    const VD exx = hn::Mul(ux, inverse0), exy = hn::Mul(uy, inverse0), exz = hn::Mul(uz, inverse0);
    // The part of ac across ab, and its direction ey. Of a sliver it is noise: it is then taken across ab and as it is,
    // which leaves the distance right, and its side is never trusted.
    const VD cx = dot(exx, exy, exz, vx, vy, vz);
    VD wx = hn::NegMulAdd(cx, exx, vx), wy = hn::NegMulAdd(cx, exy, vy), wz = hn::NegMulAdd(cx, exz, vz);
    const VD height2 = dot(wx, wy, wz, wx, wy, wz);
    const auto sliver = hn::Le(height2, hn::Mul(hn::Set(d, 1e-16), hn::Max(uu, vv)));
    // Some direction across ab for slivers: the axis along which ex is smaller than 0.8, made orthogonal.
    const auto use_x = hn::Lt(hn::Abs(exx), hn::Set(d, 0.8));
    const VD pick = hn::IfThenElse(use_x, exx, exy);
    wx = hn::IfThenElse(sliver, hn::NegMulAdd(pick, exx, hn::IfThenElse(use_x, one, zero)), wx);
    wy = hn::IfThenElse(sliver, hn::NegMulAdd(pick, exy, hn::IfThenElse(use_x, zero, one)), wy);
    wz = hn::IfThenElse(sliver, hn::Neg(hn::Mul(pick, exz)), wz);
    const VD scale = hn::Div(one, hn::Sqrt(dot(wx, wy, wz, wx, wy, wz)));
    const VD eyx = hn::Mul(wx, scale), eyy = hn::Mul(wy, scale), eyz = hn::Mul(wz, scale);
    const VD nx = hn::NegMulAdd(exz, eyy, hn::Mul(exy, eyz)), ny = hn::NegMulAdd(exx, eyz, hn::Mul(exz, eyx)),
             nz = hn::NegMulAdd(exy, eyx, hn::Mul(exx, eyy));
    const VD cy = hn::IfThenElse(sliver, zero, hn::Sqrt(height2));
    // The centre's coordinates in the plane, from a.
    const VD x0 = hn::Neg(dot(exx, exy, exz, ax, ay, az)), y0 = hn::Neg(dot(eyx, eyy, eyz, ax, ay, az));
    store(kNx, nx), store(kNy, ny), store(kNz, nz);
    store(kS, hn::Neg(dot(nx, ny, nz, ax, ay, az)));
    store(kXx, exx), store(kXy, exy), store(kXz, exz), store(kYx, eyx), store(kYy, eyy), store(kYz, eyz);
    store(kY0, y0);
    store(kLow0, hn::Neg(x0)), store(kHigh0, hn::Sub(length0, x0));
    const VD bx = hn::Sub(cx, length0), length1 = hn::Sqrt(hn::MulAdd(bx, bx, hn::Mul(cy, cy)));
    const VD inverse1 = hn::IfThenElse(hn::Gt(length1, zero), hn::Div(one, length1), zero);
    const VD u1x = hn::Mul(bx, inverse1), u1y = hn::Mul(cy, inverse1), fx = hn::Sub(x0, length0);
    store(kU1x, u1x), store(kU1y, u1y);
    store(kK1, hn::NegMulAdd(u1x, y0, hn::Mul(u1y, fx)));
    const VD low1 = hn::Neg(hn::MulAdd(u1x, fx, hn::Mul(u1y, y0)));
    store(kLow1, low1), store(kHigh1, hn::Add(low1, length1));
    const VD length2 = hn::Sqrt(hn::MulAdd(cx, cx, hn::Mul(cy, cy)));
    const VD inverse2 = hn::IfThenElse(hn::Gt(length2, zero), hn::Div(one, length2), zero);
    const VD u2x = hn::Neg(hn::Mul(cx, inverse2)), u2y = hn::Neg(hn::Mul(cy, inverse2));
    store(kU2x, u2x), store(kU2y, u2y);
    store(kK2, hn::NegMulAdd(u2x, y0, hn::Mul(u2y, x0)));
    const VD high2 = hn::Neg(hn::MulAdd(u2x, x0, hn::Mul(u2y, y0)));
    store(kLow2, hn::Sub(high2, length2)), store(kHigh2, high2);
    store(kMargin, hn::IfThenElse(sliver, hn::Set(d, 1e30), zero));
  }
}

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
  return {from[(3 * k) * stride], from[(3 * k + 1) * stride], from[(3 * k + 2) * stride]};
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

// The same by the distances themselves: those not further from the centre than the closest and the block's diameter.
size_t SelectByDistances(size_t n, const float center[3], float radius, float reach, TileScratch& scratch,
                         std::vector<uint32_t>& selected) {
  const D d;
  const hn::RebindToUnsigned<D> du;
  const size_t lanes = hn::Lanes(d), padded = RoundUp(n);
  const V cx = hn::Set(d, center[0]), cy = hn::Set(d, center[1]), cz = hn::Set(d, center[2]);
  scratch.center_distance.resize(padded / kGroup);
  float* distances = scratch.center_distance.data()->lane;
  V lowest = hn::Set(d, kInfinity);
  for (size_t i = 0; i < padded; i += lanes) {
    const float* frame = scratch.frames[i / kGroup * kNumCoefficients].lane + i % kGroup;
    V side;
    const V distance = hn::Sqrt(SquaredDistance(OfManyTriangles{frame}, cx, cy, cz, side));
    hn::Store(distance, d, distances + i);
    lowest = hn::Min(lowest, distance);
  }
  const float closest = hn::GetLane(hn::MinOfLanes(d, lowest));
  if (closest > reach) return 0;
  const V limit = hn::Set(d, closest * 1.00001f + 2 * radius + 1e-3f);
  selected.resize(padded + kGroup);
  size_t count = 0;
  for (size_t i = 0; i < padded; i += lanes) {
    auto keep = hn::Le(hn::Load(d, distances + i), limit);
    if (i + lanes > n) keep = hn::And(keep, hn::FirstN(d, n > i ? n - i : 0));
    count += hn::CompressStore(hn::Iota(du, static_cast<uint32_t>(i)), hn::RebindMask(du, keep), du,
                               selected.data() + count);
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

// Distances of the 16 voxels of a block to its candidates. Sides that are not certain are left to `exact`.
template <bool kWantsClosest>
void ComputeBlock(const Tile& tile, const int first[3], const float center[3], size_t num_candidates,
                  const ExactSide& exact, TileScratch& scratch, TileDistances& out) {
  const D d;
  const size_t lanes = hn::Lanes(d);
  scratch.squared.resize(num_candidates);
  alignas(64) float distance[16];
  alignas(64) uint32_t closest[16];
  alignas(64) uint8_t inside[16], doubtful[16];
  const float reach = tile.half_width + 2 * kTileRadius;
  const float tolerance = 4e-6f * reach, margin_value = tolerance;
  const V infinity = hn::Set(d, kInfinity), margin_least = hn::Set(d, margin_value);
  for (size_t chunk = 0; chunk < 16; chunk += lanes) {
    const V px = hn::Add(hn::Load(d, kLanes.x + chunk), hn::Set(d, center[0]));
    const V py = hn::Add(hn::Load(d, kLanes.y + chunk), hn::Set(d, center[1]));
    const V pz = hn::Add(hn::Load(d, kLanes.z + chunk), hn::Set(d, center[2]));
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
    hn::Store(hn::Min(outer_distance, inner_distance), d, distance + chunk);
    const auto is_inside = hn::Lt(inner, outer);
    const auto is_doubtful = hn::Le(hn::Abs(hn::Sub(outer_distance, inner_distance)), hn::Set(d, tolerance));
    for (size_t l = 0; l < lanes; ++l) inside[chunk + l] = doubtful[chunk + l] = 0;
    alignas(64) float flags[16];
    hn::Store(hn::IfThenElse(is_inside, hn::Set(d, 1.0f), hn::Zero(d)), d, flags);
    for (size_t l = 0; l < lanes; ++l) inside[chunk + l] = flags[l] != 0;
    hn::Store(hn::IfThenElse(is_doubtful, hn::Set(d, 1.0f), hn::Zero(d)), d, flags);
    for (size_t l = 0; l < lanes; ++l) doubtful[chunk + l] = flags[l] != 0;
  }
  for (int l = 0; l < 16; ++l) {
    if (!(distance[l] < tile.half_width)) continue;
    const int x = first[0] + (l >> 3), y = first[1] + (l >> 2 & 1), z = first[2] + (l & 3);
    bool negative = inside[l];
    if (tile.is_signed && doubtful[l]) {
      ++scratch.counters.exact;
      scratch.ties.clear();
      const float limit = (distance[l] + tolerance) * (distance[l] + tolerance);
      for (size_t i = 0; i < num_candidates; ++i)
        if (scratch.squared[i].lane[l] <= limit) scratch.ties.push_back(scratch.tile_ids[scratch.candidates[i]]);
      negative = exact.Inside(tile.origin + Eigen::Vector3i(x, y, z), scratch.ties.data(), scratch.ties.size());
    }
    out.distance[x << 6 | y << 3 | z] = tile.is_signed && negative ? -distance[l] : distance[l];
    out.active[x] |= uint64_t{1} << (y << 3 | z);
    out.any_active = true;
    if constexpr (kWantsClosest) out.closest[x << 6 | y << 3 | z] = scratch.tile_ids[scratch.candidates[closest[l]]];
  }
}

void ComputeTileImpl(const Tile& tile, const ExactSide& exact, TileScratch& scratch, TileDistances& out) {
  constexpr size_t kCullAbove = 24, kDistancesUpTo = 48;
  std::memset(out.active, 0, sizeof out.active);
  out.any_active = false;
  ++scratch.counters.tiles;
  size_t n = tile.num_triangles;
  scratch.counters.tile_triangles += n;
  scratch.tile_ids.assign(tile.triangles, tile.triangles + n);
  size_t stride = LoadCorners(tile, scratch);
  bool has_spheres = n > kCullAbove;
  if (has_spheres) {
    ComputeSpheres(stride, scratch);
    const float center[3] = {0, 0, 0}, half[3] = {3.5f, 3.5f, 3.5f};
    n = SelectBySpheres(n, stride, center, half, kTileRadius, tile.half_width + kTileRadius, scratch, scratch.kept);
    if (n == 0) return;
    stride = KeepOnly(n, stride, scratch);
    for (size_t i = 0; i < n; ++i) scratch.tile_ids[i] = tile.triangles[scratch.kept[i]];
  }
  scratch.counters.kept_triangles += n;
  ComputeFrames(stride, scratch);
  const float reach = tile.half_width + kBlockRadius + 1e-3f;
  for (int block = 0; block < 32; ++block) {
    const int first[3] = {(block >> 3) * 2, (block >> 1 & 3) * 2, (block & 1) * 4};
    const float center[3] = {first[0] - 3.0f, first[1] - 3.0f, first[2] - 2.0f};
    const size_t count =
        n <= kDistancesUpTo
            ? SelectByDistances(n, center, kBlockRadius, reach, scratch, scratch.candidates)
            : SelectBySpheres(n, stride, center, kBlockHalf, kBlockRadius, reach, scratch, scratch.candidates);
    if (count == 0) continue;
    ++scratch.counters.blocks;
    scratch.counters.candidates += count;
    if (tile.wants_closest) {
      ComputeBlock<true>(tile, first, center, count, exact, scratch, out);
    } else {
      ComputeBlock<false>(tile, first, center, count, exact, scratch, out);
    }
  }
}

const char* TargetName() { return hwy::TargetName(HWY_TARGET); }

}  // namespace glint::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace glint::internal {

HWY_EXPORT(ComputeTileImpl);
HWY_EXPORT(TargetName);

void ComputeTile(const Tile& tile, const ExactSide& exact, TileScratch& scratch, TileDistances& out) {
  HWY_DYNAMIC_DISPATCH(ComputeTileImpl)(tile, exact, scratch, out);
}

const char* TileKernelTarget() { return HWY_DYNAMIC_DISPATCH(TargetName)(); }

}  // namespace glint::internal
#endif
