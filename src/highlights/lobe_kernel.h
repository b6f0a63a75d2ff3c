// The arithmetic of the lobe's fit, many pixels at a time (lobe_fit.h has the model).
#pragma once

#include <Eigen/Core>
#include <cstddef>

namespace glint::internal {

// log amplitude, body, peak x, y, the factor of q: a, c, e, the skew: k, m, the bend b
inline constexpr int kNumLobeParams = 10;
using LobeParams = Eigen::Matrix<float, kNumLobeParams, 1>;
using LobeNormal = Eigen::Matrix<float, kNumLobeParams, kNumLobeParams>;

// Pixels of one blob; positions are relative to its centre.
struct LobeSamples {
  static constexpr size_t kMost = 256;

  void Add(float px, float py, float brightness, float sigma, bool is_saturated);
  // Fills up with samples of no weight, as the arithmetic needs.
  void Finish();

  size_t count = 0, saturated_count = 0;
  Eigen::Vector2f long_axis;  // the direction of (u, v) along which the blob is longest
  alignas(64) float x[kMost], y[kMost], value[kMost];
  alignas(64) float inverse_sigma[kMost];
  alignas(64) float saturated[kMost];  // 1: only says "at least that bright"
};

struct LobeEquations {
  LobeNormal hessian;
  LobeParams rhs;
  float cost = 0;  // scale² Σ log(1 + (r / scale)²)
};

// Residuals in units of their sigma; 0 for saturated pixels that are at least that bright.
void LobeResiduals(const LobeSamples& samples, const LobeParams& params, float* residuals);

// Cauchy-weighted normal equations.
void LineariseLobe(const LobeSamples& samples, const LobeParams& params, float scale, LobeEquations& equations);

}  // namespace glint::internal
