#include "highlights/lobe_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "highlights/lobe_kernel.h"

namespace glint {
namespace {

using internal::kNumLobeParams;
using internal::LobeEquations;
using internal::LobeParams;
using internal::LobeSamples;

constexpr double kHalfHeightQ = 0.41421356;  // (1 + q)^-2 = 1/2
constexpr double kReach = 3.4;               // radius of the fit in standard deviations of the blob (half height: 2)
constexpr float kSkewSigma = 0.2f;           // how lopsided lobes are on curved surfaces
constexpr float kBendSigma = 0.3f;           // and how bent
constexpr int kMaxIterations = 10;
constexpr int kScaleRounds = 3;      // the noise is estimated anew so many times
constexpr double kManyPixels = 160;  // fix ten parameters well
constexpr float kLeastPivot = 1e-12f;
constexpr double kPerMeasurement = 4;  // residuals of neighbouring pixels go together (blur, JPEG, shape)

struct Problem {
  LobeSamples samples;
  float body_prior = 0, body_sigma = 1;
  float log_amplitude_prior = 0;
  int stride = 1;  // one of so many pixels is looked at
};

void AddPriors(const Problem& problem, const LobeParams& p, LobeEquations& e) {
  const auto add = [&](int k, float prior, float sigma) {
    const float weight = 1 / (sigma * sigma), off = p[k] - prior;
    e.cost += weight * off * off;
    e.hessian(k, k) += weight;
    e.rhs[k] -= weight * off;
  };
  add(0, problem.log_amplitude_prior, 2);
  add(1, problem.body_prior, problem.body_sigma);
  add(7, 0, kSkewSigma);
  add(8, 0, kSkewSigma);
  add(9, 0, kBendSigma);
}

void Linearise(const Problem& problem, const LobeParams& p, float scale, LobeEquations& e) {
  internal::LineariseLobe(problem.samples, p, scale, e);
  AddPriors(problem, p, e);
}

// Of the residuals of the pixels that say something, in units of their sigma.
float RobustScale(const Problem& problem, const LobeParams& p) {
  alignas(64) std::array<float, LobeSamples::kMost> residuals;
  internal::LobeResiduals(problem.samples, p, residuals.data());
  size_t n = 0;
  for (size_t i = 0; i < problem.samples.count; ++i)
    if (residuals[i] != 0) residuals[n++] = std::abs(residuals[i]);
  if (n == 0) return 1;
  std::nth_element(residuals.begin(), residuals.begin() + n / 2, residuals.begin() + n);
  return std::max(1.4826f * residuals[n / 2], 0.3f);
}

// No lobe has more: what the equations of noise ask for overflows.
bool Plausible(const LobeParams& p) {
  constexpr float kMostLogAmplitude = 10, kMost = 1000;
  return p[0] < kMostLogAmplitude && p.cwiseAbs().maxCoeff() < kMost && p.allFinite();
}

// Cholesky's decomposition with the diagonal raised by `lambda`; infinite where the matrix is not definite.
LobeParams Solve(const internal::LobeNormal& matrix, const LobeParams& rhs, float lambda) {
  internal::LobeNormal lower;
  LobeParams x;
  for (int j = 0; j < kNumLobeParams; ++j) {
    float diagonal = matrix(j, j) * (1 + lambda) + 1e-9f;
    for (int k = 0; k < j; ++k) diagonal -= lower(j, k) * lower(j, k);
    if (diagonal < kLeastPivot) return LobeParams::Constant(std::numeric_limits<float>::infinity());
    const float inverse = 1 / std::sqrt(diagonal);
    lower(j, j) = inverse;
    float value = rhs[j];
    for (int k = 0; k < j; ++k) value -= lower(j, k) * x[k];
    x[j] = value * inverse;
    for (int i = j + 1; i < kNumLobeParams; ++i) {
      float sum = matrix(i, j);
      for (int k = 0; k < j; ++k) sum -= lower(i, k) * lower(j, k);
      lower(i, j) = sum * inverse;
    }
  }
  for (int j = kNumLobeParams - 1; j >= 0; --j) {
    for (int i = j + 1; i < kNumLobeParams; ++i) x[j] -= lower(i, j) * x[i];
    x[j] *= lower(j, j);
  }
  return x;
}

bool Minimise(const Problem& problem, LobeParams& p, float& scale) {
  float lambda = 1e-2f;
  scale = RobustScale(problem, p);
  LobeEquations now, then;
  Linearise(problem, p, scale, now);
  int scale_rounds = 1;
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    const LobeParams step = Solve(now.hessian, now.rhs, lambda);
    const LobeParams next = p + step;
    const bool small = step.segment<2>(2).norm() < 2e-3f;
    const bool plausible = Plausible(next);
    if (plausible) Linearise(problem, next, scale, then);
    if (!plausible || !(then.cost < now.cost)) {
      if (small || lambda > 1e6f) break;
      lambda *= 10;
      continue;
    }
    const bool done = small && now.cost - then.cost < 1e-3f * now.cost;
    p = next;
    lambda = std::max(lambda / 6, 1e-7f);
    std::swap(now, then);
    if (done) break;
    if (scale_rounds == kScaleRounds) continue;
    ++scale_rounds;
    scale = RobustScale(problem, p);
    Linearise(problem, p, scale, now);
  }
  return p.allFinite();
}

void Gather(const cv::Mat& map, const cv::Mat& mask, const Eigen::Vector2d& centroid, const Eigen::Matrix2d& moments,
            double body, double peak_value, double saturation, Problem& problem) {
  const double rise = peak_value - body;
  problem.body_prior = static_cast<float>(body);
  problem.body_sigma = static_cast<float>(0.15 * rise + 0.01);
  problem.log_amplitude_prior = static_cast<float>(std::log(rise));
  const Eigen::Matrix2d shape = moments + 0.25 * Eigen::Matrix2d::Identity();
  const Eigen::Matrix2d inverse = shape.inverse();
  const double rx = kReach * std::sqrt(shape(0, 0)), ry = kReach * std::sqrt(shape(1, 1));
  const int x0 = std::max(0, static_cast<int>(std::ceil(centroid.x() - rx)));
  const int x1 = std::min(map.cols - 1, static_cast<int>(std::floor(centroid.x() + rx)));
  const int y0 = std::max(0, static_cast<int>(std::ceil(centroid.y() - ry)));
  const int y1 = std::min(map.rows - 1, static_cast<int>(std::floor(centroid.y() + ry)));
  // Of many pixels only some are looked at, spread like the knights of a chessboard.
  const double area = M_PI * kReach * kReach * std::sqrt(shape.determinant());
  const int stride = problem.stride = std::max(1, static_cast<int>(std::ceil(area / kManyPixels)));
  const int turn = static_cast<int>(std::lround(0.382 * stride));
  for (int y = y0; y <= y1; ++y) {
    const uint16_t* row = map.ptr<uint16_t>(y);
    const uint8_t* in_mask = mask.empty() ? nullptr : mask.ptr<uint8_t>(y);
    const double dy = y - centroid.y();
    for (int x = x0 + (stride - x0 % stride + y % stride * turn) % stride; x <= x1; x += stride) {
      if (in_mask && !in_mask[x]) continue;
      const double dx = x - centroid.x();
      if (dx * (inverse(0, 0) * dx + 2 * inverse(0, 1) * dy) + inverse(1, 1) * dy * dy > kReach * kReach) continue;
      const double value = row[x] / 65535.0;
      const double sigma = 0.004 + 0.01 * rise + 0.03 * std::abs(value - body);
      problem.samples.Add(static_cast<float>(dx), static_cast<float>(dy), static_cast<float>(value),
                          static_cast<float>(sigma), value >= saturation);
    }
  }
}

// Where the fit begins: the blob as an upright lobe.
LobeParams Start(Problem& problem, const Eigen::Matrix2d& moments) {
  const Eigen::Matrix2d q = kHalfHeightQ / 4 * (moments + 0.1 * Eigen::Matrix2d::Identity()).inverse();
  const double a = std::sqrt(q(0, 0)), c = q(0, 1) / a, e = std::sqrt(std::max(q(1, 1) - c * c, 1e-9));
  LobeParams p = LobeParams::Zero();
  p[0] = problem.log_amplitude_prior + (problem.samples.saturated_count > 0 ? 0.7f : 0.1f);
  p[1] = problem.body_prior;
  p.segment<3>(4) << static_cast<float>(a), static_cast<float>(c), static_cast<float>(e);
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes;
  const Eigen::Vector2d major = axes.computeDirect(moments).eigenvectors().col(1);
  problem.samples.long_axis = Eigen::Vector2d(a * major.x() + c * major.y(), e * major.y()).normalized().cast<float>();
  return p;
}

// Mean deviation of the unsaturated pixels, in units of the rise.
double ProfileError(const Problem& problem, const LobeParams& p, double rise) {
  alignas(64) std::array<float, LobeSamples::kMost> residuals;
  const LobeSamples& s = problem.samples;
  internal::LobeResiduals(s, p, residuals.data());
  double sum = 0, count = 0;
  for (size_t i = 0; i < s.count; ++i) {
    if (s.saturated[i] > 0) continue;
    sum += std::min<double>(std::abs(residuals[i]) / s.inverse_sigma[i], 0.5 * rise);
    ++count;
  }
  return sum / std::max(count, 1.0) / rise;
}

}  // namespace

LobeFit FitLobe(const cv::Mat& map, const cv::Mat& mask, const Eigen::Vector2d& centroid,
                const Eigen::Matrix2d& moments, double body, double peak_value, double saturation) {
  LobeFit fit;
  Problem problem;
  Gather(map, mask, centroid, moments, body, peak_value, saturation, problem);
  LobeSamples& samples = problem.samples;
  if (samples.count < samples.saturated_count + kNumLobeParams + 1) return fit;
  samples.Finish();
  LobeParams p = Start(problem, moments);
  float scale = 1;
  if (!Minimise(problem, p, scale)) return fit;

  const Eigen::Vector2d moved = p.segment<2>(2).cast<double>();
  if (moved.dot((moments + 0.25 * Eigen::Matrix2d::Identity()).inverse() * moved) > 9) return fit;
  LobeEquations equations;
  Linearise(problem, p, scale, equations);
  Eigen::Matrix<double, kNumLobeParams, 2> of_peak = Eigen::Matrix<double, kNumLobeParams, 2>::Zero();
  of_peak.block<2, 2>(2, 0).setIdentity();
  const Eigen::Matrix2d inverse = equations.hessian.cast<double>().ldlt().solve(of_peak).block<2, 2>(2, 0);
  if (!inverse.allFinite()) return fit;

  fit.ok = true;
  fit.amplitude = std::exp(p[0]);
  fit.peak = centroid + moved;
  fit.covariance =
      std::max(1.0, kPerMeasurement / problem.stride) * scale * scale * 0.5 * (inverse + inverse.transpose());
  fit.body = p[1];
  fit.profile_error = ProfileError(problem, p, peak_value - body);
  fit.saturated_fraction = double(samples.saturated_count) / samples.count;
  return fit;
}

}  // namespace glint
