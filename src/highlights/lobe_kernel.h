// The arithmetic of the lobe's fit, many pixels at a time (lobe_fit.h has the model).
#pragma once

#include <Eigen/Core>
#include <cstddef>

namespace glint::internal {

// a, c, e are the factor of q, k and m the skew, b the bend. The peak comes last: its covariance is that of the last
// block of the normal equations' factor.
enum LobeParam { kLogAmplitude, kBody, kA, kC, kE, kK, kM, kB, kPeakX, kPeakY, kNumLobeParams };
using LobeParams = Eigen::Matrix<float, kNumLobeParams, 1>;
using LobeNormal = Eigen::Matrix<float, kNumLobeParams, kNumLobeParams>;

// Pixels of one blob; positions are relative to its centre.
struct LobeSamples {
  static constexpr size_t kMost = 256;

  // What is more than kMost is left out.
  void Add(float px, float py, float brightness) {
    if (count == kMost) return;
    x[count] = px, y[count] = py, value[count] = brightness;
    ++count;
  }
  // When all are there: standard deviations sigma + sigma_per_rise |brightness - body|; from `saturation` on a sample
  // only says "at least that bright".
  void Finish(float body, float sigma, float sigma_per_rise, float saturation);

  size_t count = 0, saturated_count = 0;
  Eigen::Vector2f long_axis;  // the direction of (u, v) along which the blob is longest
  alignas(64) float x[kMost], y[kMost], value[kMost];
  alignas(64) float inverse_sigma[kMost];
  alignas(64) float saturated[kMost];  // 1: only says "at least that bright"
};

// Of every sample, in units of its sigma: the model's derivatives, and the residual. Those of a saturated sample that
// the model is brighter than are 0.
struct LobeRows {
  static constexpr int kResidual = kNumLobeParams, kRows = kNumLobeParams + 1;

  float* Row(int k) { return values + static_cast<size_t>(k) * LobeSamples::kMost; }
  const float* Row(int k) const { return values + static_cast<size_t>(k) * LobeSamples::kMost; }

  alignas(64) float values[kRows * LobeSamples::kMost];
};

struct LobeEquations {
  LobeNormal hessian;
  LobeParams rhs;
};

void EvaluateLobe(const LobeSamples& samples, const LobeParams& params, LobeRows& rows);

// Cauchy's: scale² Σ log(1 + (residual / scale)²).
float LobeCost(size_t count, const LobeRows& rows, float scale);

// Standard deviation of the residuals by their median, to 3 %; of those that say something.
float LobeScale(size_t count, const LobeRows& rows);

// Mean deviation of the unsaturated samples in units of the rise, none counting more than half of it.
float LobeProfileError(const LobeSamples& samples, const LobeRows& rows, float rise);

// Newton's equations of the cost without the model's own second derivatives. Far residuals bend the cost down: they
// count as if it bent up by `least` of their weight; 1: re-weighted squares.
void NormaliseLobe(size_t count, const LobeRows& rows, float scale, float least, LobeEquations& equations);

}  // namespace glint::internal
