// The lobe that is closest to a blob's pixels (lobe_fit.h has the model).
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

#include "highlights/lobe_kernel.h"

namespace glint::internal {

struct LobeProblem {
  LobeSamples samples;
  float body_prior = 0, body_sigma = 1;
  float rise = 1;               // of the peak over the body
  float max_profile_error = 1;  // of the rise; what can not come so close is given up
};

struct LobeMinimum {
  const LobeRows& Rows() const { return rows[current]; }

  std::array<LobeRows, 2> rows;  // of the parameters, and those of a step that is tried
  LobeEquations equations;
  size_t current = 0;
  float scale = 1;          // of the residuals
  float profile_error = 0;  // of the rise
  LobeParams p;             // in: where to begin
};

// Levenberg-Marquardt on Cauchy's cost: re-weighted at first, then Newton's, which is faster near the minimum and loses
// its way far from it. False where no lobe comes of it.
bool MinimiseLobe(const LobeProblem& problem, LobeMinimum& minimum);

// Of the peak, for residuals of unit scale; nullopt where it is not determined.
std::optional<Eigen::Matrix2d> PeakCovariance(const LobeEquations& equations);

}  // namespace glint::internal
