#include "sdf/field_sampler.h"

#include <openvdb/tools/Interpolation.h>

#include <cmath>

namespace glint::internal {

namespace {

using openvdb::Coord;
using openvdb::Vec3d;

// Weights of four neighbours at −1, 0, 1, 2 for a sample at t in [0, 1), and their derivatives.
struct CubicWeights {
  double value[4], slope[4];
  explicit CubicWeights(double t) {
    const double t2 = t * t, t3 = t2 * t;
    value[0] = (-t3 + 2 * t2 - t) / 2, slope[0] = (-3 * t2 + 4 * t - 1) / 2;
    value[1] = (3 * t3 - 5 * t2 + 2) / 2, slope[1] = (9 * t2 - 10 * t) / 2;
    value[2] = (-3 * t3 + 4 * t2 + t) / 2, slope[2] = (-9 * t2 + 8 * t + 1) / 2;
    value[3] = (t3 - t2) / 2, slope[3] = (3 * t2 - 2 * t) / 2;
  }
};

bool Weighs(int i, int j, int k) { return (i % 3 == 0) + (j % 3 == 0) + (k % 3 == 0) < 2; }

}  // namespace

FieldSample FieldSampler::Trilinear(const Vec3d& x) const {
  using openvdb::tools::BoxSampler;
  FieldSample sample{BoxSampler::sample(accessor_, x), Vec3d(0.0)};
  for (int k = 0; k < 3; ++k) {
    Vec3d step(0.0);
    step[k] = 0.5;
    sample.gradient[k] = BoxSampler::sample(accessor_, x + step) - BoxSampler::sample(accessor_, x - step);
  }
  return sample;
}

// The 4³ voxels from `first` on; false if one of them is not active, but for those at the stencil's edges and corners,
// which weigh next to nothing: at half widths of three voxels some of them are always out of the band.
bool FieldSampler::LoadStencil(const Coord& first) {
  // The stencil touches at most two leaves along each axis.
  int begin[3], split[3];
  for (int k = 0; k < 3; ++k) {
    begin[k] = first[k] & 7;
    split[k] = std::min(4, 8 - begin[k]);  // voxels from here on are in the second leaf
  }
  for (int half = 0; half < 8; ++half) {
    int low[3], high[3];
    bool empty = false;
    Coord at = first;
    for (int k = 0; k < 3; ++k) {
      const bool second = half >> k & 1;
      low[k] = second ? split[k] : 0;
      high[k] = second ? 4 : split[k];
      at[k] += low[k];
      empty = empty || low[k] == high[k];
    }
    if (empty) continue;
    const Leaf* leaf = accessor_.probeConstLeaf(at);
    if (leaf == nullptr) {  // a tile: all of it inactive
      const float value = accessor_.getValue(at);
      for (int i = low[0]; i < high[0]; ++i)
        for (int j = low[1]; j < high[1]; ++j)
          for (int k = low[2]; k < high[2]; ++k) {
            if (Weighs(i, j, k)) return false;
            stencil_[i][j][k] = value;
          }
      continue;
    }
    for (int i = low[0]; i < high[0]; ++i)
      for (int j = low[1]; j < high[1]; ++j)
        for (int k = low[2]; k < high[2]; ++k) {
          const openvdb::Index offset =
              static_cast<openvdb::Index>(((begin[0] + i) & 7) << 6 | ((begin[1] + j) & 7) << 3 | ((begin[2] + k) & 7));
          if (!leaf->isValueOn(offset) && Weighs(i, j, k)) return false;
          stencil_[i][j][k] = leaf->getValue(offset);
        }
  }
  return true;
}

FieldSample FieldSampler::operator()(const Vec3d& x) {
  const Coord base(static_cast<int>(std::floor(x[0])), static_cast<int>(std::floor(x[1])),
                   static_cast<int>(std::floor(x[2])));
  if (!LoadStencil(base.offsetBy(-1))) return Trilinear(x);
  const CubicWeights u(x[0] - base[0]), v(x[1] - base[1]), w(x[2] - base[2]);
  FieldSample sample{0, Vec3d(0.0)};
  for (int i = 0; i < 4; ++i) {
    double plane = 0, plane_y = 0, plane_z = 0;
    for (int j = 0; j < 4; ++j) {
      const float* f = stencil_[i][j];
      const double row = w.value[0] * f[0] + w.value[1] * f[1] + w.value[2] * f[2] + w.value[3] * f[3];
      const double row_z = w.slope[0] * f[0] + w.slope[1] * f[1] + w.slope[2] * f[2] + w.slope[3] * f[3];
      plane += v.value[j] * row;
      plane_y += v.slope[j] * row;
      plane_z += v.value[j] * row_z;
    }
    sample.value += u.value[i] * plane;
    sample.gradient += Vec3d(u.slope[i] * plane, u.value[i] * plane_y, u.value[i] * plane_z);
  }
  return sample;
}

}  // namespace glint::internal
