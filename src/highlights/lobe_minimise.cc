#include "highlights/lobe_minimise.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace glint::internal {
namespace {

constexpr float kSkewSigma = 0.2f;  // how lopsided lobes are on curved surfaces
constexpr float kBendSigma = 0.3f;  // and how bent
constexpr int kMaxIterations = 8;
constexpr int kFarMoves = 3;         // until the noise is known, and which pixels are none of the lobe's
constexpr float kLeastBend = 0.2f;   // of far residuals, from then on (lobe_kernel.h)
constexpr float kSmallStep = 0.02f;  // of the peak, pixels
constexpr float kMovesAhead = 4;     // like its last that a fit may hope for
constexpr float kLeastScale = 0.3f;  // of the residuals
constexpr float kLeastPivot = 1e-12f;

template <class Visit>
void VisitPriors(const LobeProblem& problem, const Visit& visit) {
  visit(kLogAmplitude, std::log(problem.rise), 2.f);
  visit(kBody, problem.body_prior, problem.body_sigma);
  visit(kK, 0.f, kSkewSigma);
  visit(kM, 0.f, kSkewSigma);
  visit(kB, 0.f, kBendSigma);
}

float Cost(const LobeProblem& problem, const LobeParams& p, const LobeRows& rows, float scale) {
  float cost = LobeCost(problem.samples.count, rows, scale);
  VisitPriors(problem,
              [&](int k, float prior, float sigma) { cost += (p[k] - prior) * (p[k] - prior) / (sigma * sigma); });
  return cost;
}

void Normalise(const LobeProblem& problem, const LobeParams& p, const LobeRows& rows, float scale, float least,
               LobeEquations& e) {
  NormaliseLobe(problem.samples.count, rows, scale, least, e);
  VisitPriors(problem, [&](int k, float prior, float sigma) {
    const float weight = 1 / (sigma * sigma);
    e.hessian(k, k) += weight;
    e.rhs[k] -= weight * (p[k] - prior);
  });
}

// No lobe has more: what the equations of noise ask for overflows.
bool Plausible(const LobeParams& p) {
  constexpr float kMostLogAmplitude = 10, kMost = 1000;
  return p[kLogAmplitude] < kMostLogAmplitude && p.cwiseAbs().maxCoeff() < kMost && p.allFinite();
}

constexpr int kLong = 12;  // whole vectors

// Cholesky's factor by columns; the inverse of its diagonal.
template <class T>
struct Factor {
  T column[kNumLobeParams][kLong];
  T inverse[kNumLobeParams];
};

// With the diagonal raised by `lambda`; false where the matrix is not definite.
template <class T>
bool Decompose(const LobeNormal& matrix, T lambda, Factor<T>& factor) {
  for (int j = 0; j < kNumLobeParams; ++j) {
    std::array<T, kLong> column{};
    for (int i = 0; i < kNumLobeParams; ++i) column[i] = matrix(i, j);
    column[j] = column[j] * (1 + lambda) + T(1e-9);
    for (int k = 0; k < j; ++k) {
      const T share = factor.column[k][j];
      for (int i = 0; i < kLong; ++i) column[i] -= share * factor.column[k][i];
    }
    if (column[j] < kLeastPivot) return false;
    factor.inverse[j] = 1 / std::sqrt(column[j]);
    for (int i = 0; i < kLong; ++i) factor.column[j][i] = column[i] * factor.inverse[j];
  }
  return true;
}

// Infinite where there is no solution.
LobeParams Solve(const LobeEquations& equations, float lambda) {
  Factor<float> factor;
  if (!Decompose(equations.hessian, lambda, factor))
    return LobeParams::Constant(std::numeric_limits<float>::infinity());
  LobeParams x;
  float left[kLong] = {};
  for (int j = 0; j < kNumLobeParams; ++j) left[j] = equations.rhs[j];
  for (int j = 0; j < kNumLobeParams; ++j) {
    x[j] = left[j] * factor.inverse[j];
    for (int i = 0; i < kLong; ++i) left[i] -= x[j] * factor.column[j][i];
  }
  for (int j = kNumLobeParams - 1; j >= 0; --j) {
    for (int i = kNumLobeParams - 1; i > j; --i) x[j] -= factor.column[j][i] * x[i];
    x[j] *= factor.inverse[j];
  }
  return x;
}

}  // namespace

bool MinimiseLobe(const LobeProblem& problem, LobeMinimum& m) {
  const LobeSamples& samples = problem.samples;
  float lambda = 1e-2f, cost = 0;
  EvaluateLobe(samples, m.p, m.rows[m.current]);
  m.profile_error = LobeProfileError(samples, m.Rows(), problem.rise);
  bool moved = true;
  for (int iteration = 0, moves = 0; iteration < kMaxIterations; ++iteration) {
    const bool far = moves < kFarMoves;
    if (moved) {
      if (far) {
        m.scale = std::max(LobeScale(samples.count, m.Rows()), kLeastScale);
        cost = Cost(problem, m.p, m.Rows(), m.scale);
      }
      Normalise(problem, m.p, m.Rows(), m.scale, far ? 1 : kLeastBend, m.equations);
    }
    const LobeParams step = Solve(m.equations, lambda);
    const LobeParams next = m.p + step;
    const bool small = step.segment<2>(kPeakX).norm() < kSmallStep;
    float next_cost = std::numeric_limits<float>::infinity();
    if (Plausible(next)) {
      EvaluateLobe(samples, next, m.rows[1 - m.current]);
      next_cost = Cost(problem, next, m.rows[1 - m.current], m.scale);
    }
    moved = next_cost < cost;
    if (!moved) {
      if (small || lambda > 1e6f) break;
      lambda *= 10;
      continue;
    }
    const bool done = small && cost - next_cost < 1e-2f * cost;
    const float error_before = m.profile_error;
    m.p = next;
    m.current = 1 - m.current;
    m.profile_error = LobeProfileError(samples, m.Rows(), problem.rise);
    cost = next_cost;
    lambda = std::max(lambda / 6, 1e-7f);
    // Where as many steps like this one would take the profile.
    const float outlook = m.profile_error - kMovesAhead * std::max(0.f, error_before - m.profile_error);
    if (done || (++moves > 1 && outlook > problem.max_profile_error)) break;
  }
  Normalise(problem, m.p, m.Rows(), m.scale, 1, m.equations);
  return m.p.allFinite();
}

std::optional<Eigen::Matrix2d> PeakCovariance(const LobeEquations& equations) {
  Factor<double> factor;
  if (!equations.hessian.allFinite() || !Decompose(equations.hessian, 0.0, factor)) return std::nullopt;
  // The inverse of the last block times its transpose.
  const double x = factor.inverse[kPeakX], y = factor.inverse[kPeakY];
  const double both = -factor.column[kPeakX][kPeakY] * x * y;
  Eigen::Matrix2d covariance;
  covariance << x * x + both * both, both * y, both * y, y * y;
  return covariance;
}

}  // namespace glint::internal
