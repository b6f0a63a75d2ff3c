#include "light/light_fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/parallel.h"
#include "light/light_adjust.h"
#include "light/light_starts.h"

namespace glint {
namespace {

constexpr double kRadians = M_PI / 180;
constexpr double kOutlierDensity = 1 / (2 * M_PI);  // normals anywhere on the hemisphere that faces the camera
constexpr double kMinSigma = 2.5 * kRadians, kMaxSigma = 12 * kRadians;
constexpr double kMinSeparation = 10 * kRadians;
constexpr double kFirstSigma = 8 * kRadians;
constexpr int kEmRounds = 30;
constexpr int kStartsOfAKind = 3;

struct Mixture {
  std::vector<Light> lights;
  std::vector<double> shares;  // one a light; the rest are outliers
  double sigma = kFirstSigma;
  double criterion = std::numeric_limits<double>::infinity();
  Eigen::MatrixXd responsibilities;  // observation × light
};

class Fitter {
 public:
  Fitter(const std::vector<LightObservation>& observations, const Eigen::Vector3d& center, double diagonal,
         const LightFitOptions& options)
      : observations_(observations), center_(center), diagonal_(diagonal), options_(options) {}

  LightFit Run() {
    Mixture best;
    Finish(best);
    while (static_cast<int>(best.lights.size()) < options_.max_lights) {
      const Mixture next = WithOneMore(best);
      if (Repeats(next) || !(next.criterion < best.criterion - kDecisive) || LeastSupport(next) < options_.min_support)
        break;
      best = next;
    }
    TryOtherKinds(best);
    return Report(best);
  }

 private:
  static constexpr double kDecisive = 10;  // Kass, Raftery 1995: "very strong"

  double LeastSupport(const Mixture& m) const { return m.responsibilities.colwise().sum().minCoeff(); }

  // The last light is one of the others again, as far as normals this uncertain can tell.
  bool Repeats(const Mixture& m) const {
    const double least = std::max(kMinSeparation, 4 * m.sigma);
    for (size_t j = 0; j + 1 < m.lights.size(); ++j) {
      double angle = 0;
      for (const LightObservation& o : observations_) {
        const Eigen::Vector3d a = DirectionToLight(m.lights[j], o.cam_from_world, center_);
        const Eigen::Vector3d b = DirectionToLight(m.lights.back(), o.cam_from_world, center_);
        angle += std::atan2(a.cross(b).norm(), a.dot(b)) / observations_.size();
      }
      if (angle < least) return true;
    }
    return false;
  }

  // Expectation maximisation from the mixture's lights; fills everything else.
  void Finish(Mixture& m) const {
    const size_t n = observations_.size(), k = m.lights.size();
    if (m.shares.size() != k) m.shares.assign(k, 0.7 / std::max<size_t>(k, 1));
    double log_likelihood = 0;
    for (int round = 0; round <= kEmRounds; ++round) {
      const double before = log_likelihood;
      log_likelihood = Expect(m);
      if (round == kEmRounds || k == 0 || (round > 3 && log_likelihood - before < 1e-4 * n)) break;
      Maximise(m);
    }
    int parameters = 1;  // sigma
    for (const Light& light : m.lights) parameters += NumParameters(light) + 1;
    m.criterion = -2 * log_likelihood + parameters * std::log(std::max<double>(n, 2));
  }

  double Expect(Mixture& m) const {
    const size_t n = observations_.size(), k = m.lights.size();
    m.responsibilities.resize(n, k);
    double outliers = 1;
    for (double share : m.shares) outliers -= share;
    double log_likelihood = 0;
    for (size_t i = 0; i < n; ++i) {
      double total = outliers * kOutlierDensity;
      for (size_t j = 0; j < k; ++j) {
        const double e = Disagreement(observations_[i], m.lights[j], options_.max_incidence_deg) / m.sigma;
        m.responsibilities(i, j) = m.shares[j] * std::exp(-0.5 * e * e) / (2 * M_PI * m.sigma * m.sigma);
        total += m.responsibilities(i, j);
      }
      if (k > 0) m.responsibilities.row(i) /= total;
      log_likelihood += std::log(total);
    }
    return log_likelihood;
  }

  void Maximise(Mixture& m) const {
    const size_t n = observations_.size(), k = m.lights.size();
    double squares = 0, weight = 0;
    for (size_t j = 0; j < k; ++j) {
      m.shares[j] = std::clamp(m.responsibilities.col(j).sum() / n, 1e-3, 0.98);
      AdjustLight(observations_, m.responsibilities.col(j), options_.max_incidence_deg, diagonal_, m.lights[j]);
      for (size_t i = 0; i < n; ++i) {
        const double e = Disagreement(observations_[i], m.lights[j], options_.max_incidence_deg);
        if (e > 3) continue;
        squares += m.responsibilities(i, j) * e * e;
        weight += m.responsibilities(i, j);
      }
    }
    double sum = 0;
    for (double share : m.shares) sum += share;
    if (sum > 0.98)
      for (double& share : m.shares) share *= 0.98 / sum;
    if (weight > 0) m.sigma = std::clamp(std::sqrt(squares / (2 * weight)), kMinSigma, kMaxSigma);
  }

  // The mixture with the best further light of any kind.
  Mixture WithOneMore(const Mixture& base) const {
    Eigen::VectorXd unexplained = Eigen::VectorXd::Ones(observations_.size());
    if (!base.lights.empty()) unexplained -= base.responsibilities.rowwise().sum();
    const std::vector<Light> starts = Starts(unexplained);
    std::vector<Mixture> tried(starts.size());
    ParallelFor(starts.size(), 1, [&](size_t s) {
      tried[s].lights = base.lights;
      tried[s].lights.push_back(starts[s]);
      tried[s].shares = base.shares;
      double sum = 0;
      for (double share : base.shares) sum += share;
      tried[s].shares.push_back(0.6 * std::max(1 - sum, 0.02));
      tried[s].sigma = std::max(base.sigma, 0.5 * kFirstSigma);
      Finish(tried[s]);
    });
    Mixture best;
    for (Mixture& m : tried)
      if (m.criterion < best.criterion) best = std::move(m);
    return best;
  }

  std::vector<Light> Starts(const Eigen::VectorXd& unexplained) const {
    std::vector<Light> starts;
    if (options_.allow_distant && options_.allow_world) AddDirections(LightFrame::kWorld, unexplained, starts);
    if (options_.allow_distant && options_.allow_camera) AddDirections(LightFrame::kCamera, unexplained, starts);
    if (options_.allow_point && options_.allow_camera)
      starts.push_back({LightType::kPoint, LightFrame::kCamera, Eigen::Vector3d::Zero(), 0});
    if (options_.allow_point && options_.allow_world && !options_.allow_distant) {
      std::vector<Light> distant;
      AddDirections(LightFrame::kWorld, unexplained, distant);
      for (const Light& d : distant) starts.push_back(AtDistance(observations_, d, center_, 2 * diagonal_));
    }
    return starts;
  }

  void AddDirections(LightFrame frame, const Eigen::VectorXd& weights, std::vector<Light>& starts) const {
    for (const Light& light :
         LikelyDirections(observations_, weights, frame, options_.max_incidence_deg, kFirstSigma, kStartsOfAKind))
      starts.push_back(light);
  }

  // Distant lights as near ones, and near ones as distant.
  void TryOtherKinds(Mixture& best) const {
    for (size_t k = 0; k < best.lights.size(); ++k) {
      std::vector<Light> others;
      const Light light = best.lights[k];
      if (light.type == LightType::kDistant && options_.allow_point) {
        for (double diagonals : {1.0, 3.0, 10.0})
          others.push_back(AtDistance(observations_, light, center_, diagonals * diagonal_));
      } else if (light.type == LightType::kPoint && options_.allow_distant) {
        if (light.frame == LightFrame::kWorld)
          others.push_back({LightType::kDistant, light.frame, (light.vector - center_).normalized(), 0});
      }
      for (const Light& other : others) {
        Mixture m = best;
        m.lights[k] = other;
        Finish(m);
        const double margin = NumParameters(other) > NumParameters(best.lights[k]) ? kDecisive : 0;
        if (m.criterion < best.criterion - margin && LeastSupport(m) >= options_.min_support) best = std::move(m);
      }
    }
  }

  LightFit Report(const Mixture& m) const {
    LightFit fit;
    const size_t n = observations_.size(), k = m.lights.size();
    fit.normal_sigma_deg = m.sigma / kRadians;
    fit.outlier_share = 1;
    std::vector<size_t> order(k);
    for (size_t j = 0; j < k; ++j) order[j] = j;
    std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) {
      return m.responsibilities.col(a).sum() > m.responsibilities.col(b).sum();
    });
    for (size_t j : order) fit.lights.push_back(Describe(m, j));
    fit.assignment.assign(n, -1);
    for (double share : m.shares) fit.outlier_share -= share;
    for (size_t i = 0; i < n; ++i)
      for (size_t j = 0; j < k; ++j)
        if (m.responsibilities(i, order[j]) > 0.5) fit.assignment[i] = static_cast<int>(j);
    return fit;
  }

  FoundLight Describe(const Mixture& m, size_t j) const {
    FoundLight out;
    out.light = m.lights[j];
    const Eigen::VectorXd weights = m.responsibilities.col(j);
    out.support = weights.sum();
    const Eigen::Matrix3d hessian =
        LineariseLight(observations_, weights, out.light, options_.max_incidence_deg, diagonal_).hessian;
    const int p = NumParameters(out.light);
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(hessian.topLeftCorner(p, p));
    const Eigen::VectorXd values = eigen.eigenvalues().cwiseMax(1e-12);
    out.conditioning = values[0] / values[p - 1];
    // Highlights near each other share the error of the surface under them: about four count as one.
    const Eigen::MatrixXd root = 2 * m.sigma * eigen.eigenvectors() * values.cwiseSqrt().cwiseInverse().asDiagonal();
    const Eigen::MatrixXd spread = TangentBasis(out.light, diagonal_).leftCols(p) * root;
    out.covariance = spread * spread.transpose();
    const double sigma = 2 * m.sigma / std::sqrt(values[0]);
    out.light.sigma = p == 2 ? std::min(sigma / kRadians, 90.0) : sigma * diagonal_;
    Mixture without = m;
    without.lights.erase(without.lights.begin() + static_cast<long>(j));
    without.shares.erase(without.shares.begin() + static_cast<long>(j));
    Finish(without);
    out.criterion_gain = without.criterion - m.criterion;
    return out;
  }

  const std::vector<LightObservation>& observations_;
  const Eigen::Vector3d center_;
  const double diagonal_;
  const LightFitOptions& options_;
};

}  // namespace

LightFit FitLights(const std::vector<LightObservation>& observations, const Eigen::Vector3d& center, double diagonal,
                   const LightFitOptions& options) {
  return Fitter(observations, center, diagonal, options).Run();
}

}  // namespace glint
