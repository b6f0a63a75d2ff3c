#include "highlights/lobe_kernel.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

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
      samples.Add(x, y, value, 0.01f + 0.02f * value, value >= 0.93f);
    }
  samples.Finish();
  return samples;
}

LobeParams Somewhere() {
  LobeParams p;
  p << 0.02f, 0.1f, 0.3f, -0.25f, 0.2f, 0.03f, 0.3f, 0.05f, -0.04f, 0.06f;
  return p;
}

double Cost(const LobeSamples& samples, const LobeParams& p, double scale) {
  std::array<float, LobeSamples::kMost> residuals;
  LobeResiduals(samples, p, residuals.data());
  double cost = 0;
  for (size_t i = 0; i < samples.count; ++i) cost += std::log1p(std::pow(residuals[i] / scale, 2));
  return scale * scale * cost;
}

TEST(LobeKernel, RightHandSideIsTheCostsGradient) {
  const LobeSamples samples = Samples();
  ASSERT_GT(samples.saturated_count, 0u);
  LobeEquations equations;
  LineariseLobe(samples, Somewhere(), 1.5f, equations);
  EXPECT_NEAR(equations.cost, Cost(samples, Somewhere(), 1.5), 1e-3 * equations.cost);
  for (int k = 0; k < kNumLobeParams; ++k) {
    LobeParams ahead = Somewhere(), behind = Somewhere();
    ahead[k] += 2e-3f, behind[k] -= 2e-3f;
    const double slope =
        (Cost(samples, ahead, 1.5) - Cost(samples, behind, 1.5)) / (double(ahead[k]) - double(behind[k]));
    EXPECT_NEAR(-2 * equations.rhs[k], slope, 0.02 * std::abs(slope) + 0.3) << "parameter " << k;
  }
  EXPECT_TRUE(equations.hessian.isApprox(equations.hessian.transpose()));
  EXPECT_GT(equations.hessian.cast<double>().eval().ldlt().vectorD().minCoeff(), 0);
}

TEST(LobeKernel, SaturatedPixelsOnlyBoundFromBelow) {
  LobeSamples samples = Samples();
  LobeParams bright = Somewhere();
  bright[0] = 2;  // far above saturation
  std::array<float, LobeSamples::kMost> residuals;
  LobeResiduals(samples, bright, residuals.data());
  for (size_t i = 0; i < samples.count; ++i) {
    if (samples.saturated[i] > 0) {
      EXPECT_EQ(residuals[i], 0);
    }
  }
  bright[0] = -1;
  LobeResiduals(samples, bright, residuals.data());
  for (size_t i = 0; i < samples.count; ++i) {
    if (samples.saturated[i] > 0) {
      EXPECT_LT(residuals[i], 0);
    }
  }
}

}  // namespace
}  // namespace glint::internal
