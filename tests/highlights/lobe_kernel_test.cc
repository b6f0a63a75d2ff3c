#include "highlights/lobe_kernel.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <vector>

#include "core/square.h"

namespace glint::internal {
namespace {

// A bent, lopsided lobe whose core is saturated, on 15 × 13 pixels.
LobeSamples Samples() {
  LobeSamples samples;
  samples.long_axis = Eigen::Vector2f(0.8f, 0.6f);
  for (int y = -6; y <= 6; ++y)
    for (int x = -7; x <= 7; ++x) {
      const float q = 0.05f * (x - 0.4f) * (x - 0.4f) + 0.11f * (y + 0.2f) * (y + 0.2f) + 0.01f * x * y;
      const float value = std::min(0.12f + 0.9f / ((1 + q) * (1 + q)) + 0.01f * std::sin(3.0f * x + 5.0f * y), 0.93f);
      samples.Add(x, y, value);
    }
  samples.Finish(0, 0.01f, 0.02f, 0.93f);
  return samples;
}

LobeParams Somewhere() {
  LobeParams p;
  p[kLogAmplitude] = 0.02f, p[kBody] = 0.1f, p[kPeakX] = 0.3f, p[kPeakY] = -0.25f;
  p[kA] = 0.2f, p[kC] = 0.03f, p[kE] = 0.3f, p[kK] = 0.05f, p[kM] = -0.04f, p[kB] = 0.06f;
  return p;
}

LobeRows Rows(const LobeSamples& samples, const LobeParams& p) {
  LobeRows rows;
  EvaluateLobe(samples, p, rows);
  return rows;
}

TEST(LobeKernel, RightHandSideIsTheCostsGradient) {
  const LobeSamples samples = Samples();
  ASSERT_GT(samples.saturated_count, 0u);
  constexpr float kScale = 1.5f;
  const LobeRows rows = Rows(samples, Somewhere());
  double plain = 0;
  for (size_t i = 0; i < samples.count; ++i) plain += std::log1p(Square(rows.Row(LobeRows::kResidual)[i] / kScale));
  EXPECT_NEAR(LobeCost(samples.count, rows, kScale), kScale * kScale * plain, 1e-3 * plain);
  for (const float least : {1.f, 0.2f}) {
    LobeEquations equations;
    NormaliseLobe(samples.count, rows, kScale, least, equations);
    for (int k = 0; k < kNumLobeParams; ++k) {
      LobeParams ahead = Somewhere(), behind = Somewhere();
      ahead[k] += 2e-3f, behind[k] -= 2e-3f;
      const double slope = (double(LobeCost(samples.count, Rows(samples, ahead), kScale)) -
                            LobeCost(samples.count, Rows(samples, behind), kScale)) /
                           (double(ahead[k]) - double(behind[k]));
      EXPECT_NEAR(-2 * equations.rhs[k], slope, 0.02 * std::abs(slope) + 0.3) << "parameter " << k;
    }
    EXPECT_TRUE(equations.hessian.isApprox(equations.hessian.transpose()));
    EXPECT_GT(equations.hessian.cast<double>().eval().ldlt().vectorD().minCoeff(), 0);
  }
}

TEST(LobeKernel, ScaleIsTheMedianOfWhatSaysSomething) {
  const LobeSamples samples = Samples();
  const LobeRows rows = Rows(samples, Somewhere());
  std::vector<float> off;
  for (size_t i = 0; i < samples.count; ++i)
    if (const float r = std::abs(rows.Row(LobeRows::kResidual)[i]); r != 0) off.push_back(r);
  std::nth_element(off.begin(), off.begin() + off.size() / 2, off.end());
  EXPECT_NEAR(LobeScale(samples.count, rows), 1.4826 * off[off.size() / 2], 0.05 * off[off.size() / 2]);
}

TEST(LobeKernel, ProfileErrorIsTheMeanDeviation) {
  const LobeSamples samples = Samples();
  const LobeRows rows = Rows(samples, Somewhere());
  double sum = 0;
  int count = 0;
  for (size_t i = 0; i < samples.count; ++i) {
    if (samples.saturated[i] > 0) continue;
    sum += std::min(std::abs(rows.Row(LobeRows::kResidual)[i]) / samples.inverse_sigma[i], 0.2f);
    ++count;
  }
  EXPECT_NEAR(LobeProfileError(samples, rows, 0.4f), sum / count / 0.4, 1e-4);
}

TEST(LobeKernel, SaturatedPixelsOnlyBoundFromBelow) {
  const LobeSamples samples = Samples();
  LobeParams params = Somewhere();
  params[kLogAmplitude] = 2;  // far above saturation
  const LobeRows bright = Rows(samples, params);
  params[kLogAmplitude] = -1;
  const LobeRows dark = Rows(samples, params);
  for (size_t i = 0; i < samples.count; ++i) {
    if (samples.saturated[i] == 0) continue;
    EXPECT_EQ(bright.Row(LobeRows::kResidual)[i], 0);
    EXPECT_EQ(bright.Row(kBody)[i], 0);
    EXPECT_LT(dark.Row(LobeRows::kResidual)[i], 0);
  }
}

}  // namespace
}  // namespace glint::internal
