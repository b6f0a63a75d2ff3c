// Triangles in the frame of a tile: what the kernel reads of them. Included by tile_kernel.cc for each target.
#if defined(GLINT_SDF_TILE_FRAMES_INL_H) == defined(HWY_TARGET_TOGGLE)  // once a target
#ifdef GLINT_SDF_TILE_FRAMES_INL_H
#undef GLINT_SDF_TILE_FRAMES_INL_H
#else
#define GLINT_SDF_TILE_FRAMES_INL_H
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <limits>

#include "sdf/tile_kernel.h"

// Once a target, each in a namespace of its own.
// NOLINTBEGIN(misc-definitions-in-headers)
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

// Reads coefficients of one triangle for all lanes.
struct OfOneTriangle {
  const float* at;
  HWY_INLINE V operator[](int k) const { return hn::Set(D(), at[k * kGroup]); }
};

// Squared distance of p from the triangle, and the signed distance from its plane.
HWY_INLINE V SquaredDistance(const OfOneTriangle& c, V px, V py, V pz, V& side) {
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

// The 32 blocks of a tile: their first voxels, and their centres about the tile's.
constexpr int kNumBlocks = 32;
constexpr int FirstOf(int block, int axis) {
  return axis == 0 ? (block >> 3) * 2 : axis == 1 ? (block >> 1 & 3) * 2 : (block & 1) * 4;
}
struct alignas(64) BlockCenters {
  float x[kNumBlocks], y[kNumBlocks], z[kNumBlocks];
  constexpr BlockCenters() : x(), y(), z() {
    for (int b = 0; b < kNumBlocks; ++b) {
      x[b] = static_cast<float>(FirstOf(b, 0)) - 3.0f;
      y[b] = static_cast<float>(FirstOf(b, 1)) - 3.0f;
      z[b] = static_cast<float>(FirstOf(b, 2)) - 2.0f;
    }
  }
};
constexpr BlockCenters kBlocks;
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

// Works out the frames of the first n triangles.
void ComputeFrames(size_t n, size_t stride, TileScratch& scratch) {
  const Half d;
  const hn::Rebind<float, Half> df;
  using VD = hn::Vec<Half>;
  const size_t lanes = hn::Lanes(d);
  scratch.frames.resize(stride / kGroup * kNumCoefficients);
  const double* from = scratch.corners.data();
  const VD zero = hn::Zero(d), one = hn::Set(d, 1.0);
  for (size_t i = 0; i < n; i += lanes) {
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

}  // namespace glint::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
// NOLINTEND(misc-definitions-in-headers)

#endif  // GLINT_SDF_TILE_FRAMES_INL_H
