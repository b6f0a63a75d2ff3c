#include "highlights/lobe_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

namespace glint {
namespace {

// log amplitude, body, peak x, y, the factor of q: a, c, e, the skew: k, m, the bend b
constexpr int kNumParams = 10;
using Params = Eigen::Matrix<double, kNumParams, 1>;
using Normal = Eigen::Matrix<double, kNumParams, kNumParams>;

constexpr double kHalfHeightQ = 0.41421356;  // (1 + q)^-2 = 1/2
constexpr double kReach = 3.4;               // radius of the fit in standard deviations of the blob (half height: 2)
constexpr double kSkewSigma = 0.2;           // how lopsided lobes are on curved surfaces
constexpr double kBendSigma = 0.3;           // and how bent
constexpr int kMaxIterations = 20;
constexpr int kManyPixels = 400;

struct Sample {
  Eigen::Vector2d at;
  double value;
  double sigma;  // noise and what no lobe model follows
  bool saturated;
};

struct Problem {
  std::vector<Sample> samples;
  double body_prior, body_sigma;
  double log_amplitude_prior;
  bool sparse;                // every other pixel left out
  Eigen::Vector2d long_axis;  // the direction of (u, v) along which the blob is longest
};

// Value and gradient of the model: w = (u, v) = (a dx + c dy, e dy), bent to w' = w + b (w·long)² across,
// q = |w'|² exp(k u + m v).
double Evaluate(const Params& p, double amplitude, const Eigen::Vector2d& long_axis, const Eigen::Vector2d& at,
                Params* gradient) {
  const double dx = at.x() - p[2], dy = at.y() - p[3];
  const double u = p[4] * dx + p[5] * dy, v = p[6] * dy;
  const double along = long_axis.x() * u + long_axis.y() * v;
  const double bent_u = u - p[9] * along * along * long_axis.y(), bent_v = v + p[9] * along * along * long_axis.x();
  const double skew = std::exp(std::clamp(p[7] * u + p[8] * v, -3.0, 3.0));
  const double q = (bent_u * bent_u + bent_v * bent_v) * skew;
  const double f = 1 / ((1 + q) * (1 + q));
  if (gradient) {
    const double df = -2 * amplitude * f / (1 + q);  // by q
    const double across = bent_v * long_axis.x() - bent_u * long_axis.y();
    const double turn = 2 * p[9] * along * across;
    const double du = df * (2 * (bent_u + turn * long_axis.x()) * skew + p[7] * q);
    const double dv = df * (2 * (bent_v + turn * long_axis.y()) * skew + p[8] * q);
    *gradient << amplitude * f, 1, -du * p[4], -(du * p[5] + dv * p[6]), du * dx, du * dy, dv * dy, df * q * u,
        df * q * v, df * 2 * across * along * along * skew;
  }
  return p[1] + amplitude * f;
}

// Normal equations of the weighted residuals and the robust cost.
double Linearise(const Problem& problem, const Params& p, double scale, Normal* hessian, Params* rhs) {
  // The sum of log(1 + ratio²), as the logarithm of products that cannot overflow.
  double log_sum = 0, product = 1;
  if (hessian) {
    hessian->setZero();
    rhs->setZero();
  }
  Params g;
  const double amplitude = std::exp(p[0]);
  for (const Sample& s : problem.samples) {
    const double r = (Evaluate(p, amplitude, problem.long_axis, s.at, hessian ? &g : nullptr) - s.value) / s.sigma;
    if (s.saturated && r > 0) continue;  // at least that bright
    const double ratio = r / scale;
    product *= 1 + ratio * ratio;
    if (product > 1e100) {
      log_sum += std::log(product);
      product = 1;
    }
    if (!hessian) continue;
    const double w = 1 / (1 + ratio * ratio) / (s.sigma * s.sigma);
    hessian->noalias() += w * g * g.transpose();
    *rhs -= w * r * s.sigma * g;
  }
  double cost = scale * scale * (log_sum + std::log(product));
  const double body = (p[1] - problem.body_prior) / problem.body_sigma;
  const double log_amplitude = (p[0] - problem.log_amplitude_prior) / 2;
  const double skew_weight = 1 / (kSkewSigma * kSkewSigma);
  const double bend_weight = 1 / (kBendSigma * kBendSigma);
  cost += body * body + log_amplitude * log_amplitude + skew_weight * p.segment<2>(7).squaredNorm() +
          bend_weight * p[9] * p[9];
  if (hessian) {
    (*hessian)(1, 1) += 1 / (problem.body_sigma * problem.body_sigma);
    (*rhs)[1] -= body / problem.body_sigma;
    (*hessian)(0, 0) += 0.25;
    (*rhs)[0] -= log_amplitude / 2;
    hessian->diagonal().segment<2>(7).array() += skew_weight;
    rhs->segment<2>(7) -= skew_weight * p.segment<2>(7);
    (*hessian)(9, 9) += bend_weight;
    (*rhs)[9] -= bend_weight * p[9];
  }
  return cost;
}

// Residuals of the pixels that count at the current parameters, in units of their sigma.
std::vector<double> AbsoluteResiduals(const Problem& problem, const Params& p) {
  std::vector<double> residuals;
  residuals.reserve(problem.samples.size());
  const double amplitude = std::exp(p[0]);
  for (const Sample& s : problem.samples) {
    const double r = (Evaluate(p, amplitude, problem.long_axis, s.at, nullptr) - s.value) / s.sigma;
    if (!s.saturated || r < 0) residuals.push_back(std::abs(r));
  }
  return residuals;
}

double RobustScale(std::vector<double> residuals) {
  if (residuals.empty()) return 1;
  std::nth_element(residuals.begin(), residuals.begin() + residuals.size() / 2, residuals.end());
  return std::max(1.4826 * residuals[residuals.size() / 2], 0.3);
}

bool Minimise(const Problem& problem, Params& p, double& scale) {
  double lambda = 1e-2;
  scale = RobustScale(AbsoluteResiduals(problem, p));
  Normal hessian;
  Params rhs;
  double cost = Linearise(problem, p, scale, &hessian, &rhs);
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    Normal damped = hessian;
    damped.diagonal() *= 1 + lambda;
    damped.diagonal().array() += 1e-12;
    const Params step = damped.ldlt().solve(rhs);
    const Params next = p + step;
    const double next_cost = next.allFinite() ? Linearise(problem, next, scale, nullptr, nullptr) : cost + 1;
    if (!(next_cost < cost)) {
      lambda *= 8;
      if (lambda > 1e8) break;
      continue;
    }
    const bool done = step.segment<2>(2).norm() < 1e-3 && cost - next_cost < 1e-4 * cost;
    p = next;
    lambda = std::max(lambda / 6, 1e-9);
    scale = RobustScale(AbsoluteResiduals(problem, p));
    cost = Linearise(problem, p, scale, &hessian, &rhs);
    if (done) break;
  }
  return p.allFinite();
}

Problem Gather(const cv::Mat& map, const cv::Mat& mask, const Eigen::Vector2d& centroid, const Eigen::Matrix2d& moments,
               double body, double peak_value, double saturation) {
  Problem problem;
  const double rise = peak_value - body;
  problem.body_prior = body;
  problem.body_sigma = 0.15 * rise + 0.01;
  problem.log_amplitude_prior = std::log(rise);
  const Eigen::Matrix2d shape = moments + 0.25 * Eigen::Matrix2d::Identity();
  const Eigen::Matrix2d inverse = shape.inverse();
  const double rx = kReach * std::sqrt(shape(0, 0)), ry = kReach * std::sqrt(shape(1, 1));
  const int x0 = std::max(0, static_cast<int>(std::ceil(centroid.x() - rx)));
  const int x1 = std::min(map.cols - 1, static_cast<int>(std::floor(centroid.x() + rx)));
  const int y0 = std::max(0, static_cast<int>(std::ceil(centroid.y() - ry)));
  const int y1 = std::min(map.rows - 1, static_cast<int>(std::floor(centroid.y() + ry)));
  // A few hundred pixels fix nine parameters; of more every other one is left out, as on a chessboard.
  const bool sparse = problem.sparse = (x1 - x0 + 1) * (y1 - y0 + 1) > kManyPixels;
  for (int y = y0; y <= y1; ++y)
    for (int x = x0 + (sparse ? (x0 + y) % 2 : 0); x <= x1; x += sparse ? 2 : 1) {
      if (!mask.empty() && !mask.ptr<uint8_t>(y)[x]) continue;
      const Eigen::Vector2d at(x, y);
      if ((at - centroid).dot(inverse * (at - centroid)) > kReach * kReach) continue;
      const double value = map.ptr<uint16_t>(y)[x] / 65535.0;
      problem.samples.push_back({at, value, 0.004 + 0.01 * rise + 0.03 * std::abs(value - body), value >= saturation});
    }
  return problem;
}

}  // namespace

LobeFit FitLobe(const cv::Mat& map, const cv::Mat& mask, const Eigen::Vector2d& centroid,
                const Eigen::Matrix2d& moments, double body, double peak_value, double saturation) {
  LobeFit fit;
  Problem problem = Gather(map, mask, centroid, moments, body, peak_value, saturation);
  const size_t num_saturated =
      std::count_if(problem.samples.begin(), problem.samples.end(), [](const Sample& s) { return s.saturated; });
  if (problem.samples.size() < num_saturated + kNumParams + 1) return fit;

  const Eigen::Matrix2d q = kHalfHeightQ / 4 * (moments + 0.1 * Eigen::Matrix2d::Identity()).inverse();
  Params p;
  p[0] = problem.log_amplitude_prior + (num_saturated > 0 ? 0.7 : 0.1);
  p[1] = body;
  p.segment<2>(2) = centroid;
  p[4] = std::sqrt(q(0, 0));
  p[5] = q(0, 1) / p[4];
  p[6] = std::sqrt(std::max(q(1, 1) - p[5] * p[5], 1e-9));
  p.tail<3>().setZero();
  const Eigen::Vector2d major = Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(moments).eigenvectors().col(1);
  problem.long_axis = Eigen::Vector2d(p[4] * major.x() + p[5] * major.y(), p[6] * major.y()).normalized();
  double scale = 1;
  if (!Minimise(problem, p, scale)) return fit;

  const Eigen::Vector2d moved = p.segment<2>(2) - centroid;
  if (moved.dot((moments + 0.25 * Eigen::Matrix2d::Identity()).inverse() * moved) > 9) return fit;
  Normal hessian;
  Params rhs;
  Linearise(problem, p, scale, &hessian, &rhs);
  const Normal inverse = hessian.ldlt().solve(Normal::Identity());
  if (!inverse.allFinite()) return fit;

  fit.amplitude = std::exp(p[0]);
  double sum = 0, count = 0;
  for (const Sample& s : problem.samples) {
    if (s.saturated) continue;
    const double r = std::abs(Evaluate(p, fit.amplitude, problem.long_axis, s.at, nullptr) - s.value);
    sum += std::min(r, 0.5 * (peak_value - body));
    ++count;
  }
  fit.ok = true;
  fit.peak = p.segment<2>(2);
  // Residuals of neighbouring pixels go together (blur, JPEG, shape): about four pixels make one measurement.
  fit.covariance = (problem.sparse ? 2 : 4) * scale * scale * inverse.block<2, 2>(2, 2);
  fit.covariance = (0.5 * (fit.covariance + fit.covariance.transpose())).eval();
  fit.body = p[1];
  fit.profile_error = sum / std::max(count, 1.0) / (peak_value - body);
  fit.saturated_fraction = double(num_saturated) / problem.samples.size();
  return fit;
}

}  // namespace glint
