#include "light/light_fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/check.h"
#include "core/parallel.h"
#include "light/light_adjust.h"
#include "light/light_covariance.h"
#include "light/light_starts.h"

namespace glint {
namespace {

constexpr double kRadians = M_PI / 180;
constexpr double kOutlierDensity = 1 / (2 * M_PI);  // normals anywhere on the hemisphere that faces the camera
constexpr double kFreedom = 3;                      // of Student's distribution of the normals' errors
constexpr double kNever = 3;                        // radians; see Disagreement()
constexpr double kMinSigma = 2 * kRadians, kMaxSigma = 6 * kRadians;
constexpr double kMinSeparation = 10 * kRadians;
constexpr double kFirstSigma = 8 * kRadians;
constexpr int kEmRounds = 30;
constexpr int kStartsOfAKind = 3;
// How far from the camera a flash is expected, as a share of the distance to the object.
constexpr double kFlashSpread = 0.15;

struct Mixture {
  std::vector<Light> lights;
  std::vector<double> shares;  // one a light; the rest are outliers
  std::vector<double> sigmas;  // of the normals under each light's highlights: seeds are better here and worse there
  double criterion = std::numeric_limits<double>::infinity();
  Eigen::MatrixXd responsibilities;  // observation × light
  Eigen::MatrixXd weights;           // the same, less for those in the tails
};

class Fitter {
 public:
  Fitter(const std::vector<LightObservation>& observations, const Eigen::Vector3d& center, double diagonal,
         const LightFitOptions& options)
      : observations_(observations), center_(center), diagonal_(diagonal), options_(options) {
    for (const LightObservation& o : observations)
      flash_spread_ += kFlashSpread * (o.cam_from_world * center).norm() / diagonal / observations.size();
  }

  Mixture Search() const {
    Mixture best;
    Finish(best);
    while (static_cast<int>(best.lights.size()) < options_.max_lights) {
      const Mixture next = WithOneMore(best);
      if (Repeats(next) || !(next.criterion < best.criterion - kDecisive) || LeastSupport(next) < options_.min_support)
        break;
      best = next;
    }
    TryOtherKinds(best);
    return best;
  }

  LightFit Report(const Mixture& m) const;

 private:
  static constexpr double kDecisive = 10;  // Kass, Raftery 1995: "very strong"

  double LeastSupport(const Mixture& m) const { return m.responsibilities.colwise().sum().minCoeff(); }

  // Two of the lights are the same, as far as normals this uncertain can tell.
  bool Repeats(const Mixture& m) const {
    for (size_t j = 0; j < m.lights.size(); ++j)
      for (size_t k = 0; k < j; ++k)
        if (MeanAngle(m.lights[j], m.lights[k]) < std::max(kMinSeparation, 4 * std::max(m.sigmas[j], m.sigmas[k])))
          return true;
    return false;
  }

  double MeanAngle(const Light& one, const Light& other) const {
    double angle = 0;
    for (const LightObservation& o : observations_) {
      const Eigen::Vector3d a = DirectionToLight(one, o.cam_from_world, center_);
      const Eigen::Vector3d b = DirectionToLight(other, o.cam_from_world, center_);
      angle += std::atan2(a.cross(b).norm(), a.dot(b)) / observations_.size();
    }
    return angle;
  }

  // Expectation maximisation from the mixture's lights; fills everything else.
  void Finish(Mixture& m) const {
    const size_t n = observations_.size(), k = m.lights.size();
    GLINT_CHECK_EQ(m.shares.size(), k);
    GLINT_CHECK_EQ(m.sigmas.size(), k);
    double log_likelihood = 0;
    for (int round = 0; round <= kEmRounds; ++round) {
      const double before = log_likelihood;
      log_likelihood = Expect(m);
      if (round == kEmRounds || k == 0 || (round > 3 && log_likelihood - before < 1e-4 * n)) break;
      Maximise(m);
    }
    m.criterion = -2 * log_likelihood;
    for (const Light& light : m.lights) m.criterion += Complexity(light);
  }

  static bool Flash(const Light& light) {
    return light.type == LightType::kPoint && light.frame == LightFrame::kCamera;
  }

  // What a light costs: its share, its sigma and its parameters. A flash is where one expects it, and that is worth two
  // of them.
  double Complexity(const Light& light) const {
    const double log_n = std::log(std::max<double>(observations_.size(), 2));
    if (!Flash(light)) return (2 + NumParameters(light)) * log_n;
    return 3 * log_n + (light.vector / (flash_spread_ * diagonal_)).squaredNorm();
  }

  double Prior(double sigma) const { return std::pow(sigma / flash_spread_, 2); }

  double Expect(Mixture& m) const {
    const size_t n = observations_.size(), k = m.lights.size();
    m.responsibilities.resize(n, k);
    m.weights.resize(n, k);
    double outliers = 1;
    for (double share : m.shares) outliers -= share;
    double log_likelihood = 0;
    for (size_t i = 0; i < n; ++i) {
      double total = outliers * kOutlierDensity;
      for (size_t j = 0; j < k; ++j) {
        const double angle = Disagreement(observations_[i], m.lights[j], options_.max_incidence_deg);
        // Student's distribution in the plane across the half vector: seeds have normals that are much further off.
        const double tail = 1 + angle * angle / (kFreedom * m.sigmas[j] * m.sigmas[j]);
        const double density = std::pow(tail, -(kFreedom + 2) / 2) / (2 * M_PI * m.sigmas[j] * m.sigmas[j]);
        m.responsibilities(i, j) = angle < kNever ? m.shares[j] * density : 0;
        m.weights(i, j) = (kFreedom + 2) / (kFreedom * tail);
        total += m.responsibilities(i, j);
      }
      if (k > 0) m.responsibilities.row(i) /= total;
      log_likelihood += std::log(total);
    }
    m.weights.array() *= m.responsibilities.array();
    return log_likelihood;
  }

  void Maximise(Mixture& m) const {
    const size_t n = observations_.size(), k = m.lights.size();
    for (size_t j = 0; j < k; ++j) {
      double squares = 0, weight = 0;
      m.shares[j] = std::clamp(m.responsibilities.col(j).sum() / n, 1e-3, 0.98);
      AdjustLight(observations_, m.weights.col(j), options_.max_incidence_deg, diagonal_, Prior(m.sigmas[j]),
                  m.lights[j]);
      for (size_t i = 0; i < n; ++i) {
        const double angle = Disagreement(observations_[i], m.lights[j], options_.max_incidence_deg);
        if (angle > kNever) continue;
        squares += m.weights(i, j) * angle * angle;
        weight += m.responsibilities(i, j);
      }
      if (weight > 0) m.sigmas[j] = std::clamp(std::sqrt(squares / (2 * weight)), kMinSigma, kMaxSigma);
    }
    double sum = 0;
    for (double share : m.shares) sum += share;
    if (sum > 0.98)
      for (double& share : m.shares) share *= 0.98 / sum;
  }

  // The mixture with the best further light of any kind: beside those there are, or one of them made two.
  Mixture WithOneMore(const Mixture& base) const {
    Eigen::VectorXd unexplained = Eigen::VectorXd::Ones(observations_.size());
    if (!base.lights.empty()) unexplained -= base.responsibilities.rowwise().sum();
    std::vector<Mixture> tried;
    for (const Light& start : Starts(unexplained)) {
      Mixture& m = tried.emplace_back();
      m.lights = base.lights;
      m.lights.push_back(start);
      m.shares = base.shares;
      m.shares.push_back(0.6 * std::max(1 - std::accumulate(m.shares.begin(), m.shares.end(), 0.0), 0.02));
      m.sigmas = base.sigmas;
      m.sigmas.push_back(0.5 * kFirstSigma);
    }
    for (size_t k = 0; k < base.lights.size(); ++k) {
      const std::vector<Light> modes =
          LikelyDirections(observations_, base.responsibilities.col(k), base.lights[k].frame,
                           options_.max_incidence_deg, 0.5 * kFirstSigma, 2);
      if (!options_.allow_distant || modes.size() < 2) continue;
      Mixture& m = tried.emplace_back();
      m.lights = base.lights;
      m.lights[k] = modes[0];
      m.lights.push_back(modes[1]);
      m.shares = base.shares;
      m.shares[k] /= 2;
      m.shares.push_back(m.shares[k]);
      m.sigmas = base.sigmas;
      m.sigmas[k] = 0.5 * kFirstSigma;
      m.sigmas.push_back(m.sigmas[k]);
    }
    ParallelFor(tried.size(), 1, [&](size_t t) { Finish(tried[t]); });
    Mixture best;
    for (Mixture& m : tried)
      if (m.criterion + kDecisive * Boldness(m) < best.criterion + kDecisive * Boldness(best)) best = std::move(m);
    return best;
  }

  std::vector<Light> Starts(const Eigen::VectorXd& unexplained) const {
    std::vector<Light> starts;
    if (options_.allow_distant && options_.allow_world) AddDirections(LightFrame::kWorld, unexplained, starts);
    // A lamp that is very near is two distant ones to who does not try it so.
    if (options_.allow_distant && options_.allow_world && options_.allow_point && !starts.empty())
      for (const double diagonals : {0.8, 2.0})
        starts.push_back(AtDistance(observations_, starts.front(), center_, diagonals * diagonal_));
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
    for (const double sigma : {kFirstSigma, 0.5 * kFirstSigma})
      for (const Light& light :
           LikelyDirections(observations_, weights, frame, options_.max_incidence_deg, sigma, kStartsOfAKind))
        starts.push_back(light);
  }

  // Distant lights as near ones, and near ones as distant.
  void TryOtherKinds(Mixture& best) const {
    for (size_t k = 0; k < best.lights.size(); ++k) {
      const Light light = best.lights[k];
      for (const Light& other : OtherKinds(light)) {
        Mixture m = best;
        m.lights[k] = other;
        Finish(m);
        const double margin = kDecisive * (Boldness(other) - Boldness(best.lights[k]));
        const bool near = other.type == LightType::kPoint && !Flash(other);
        if (m.criterion < best.criterion - margin && LeastSupport(m) >= options_.min_support &&
            (!near || DistanceIsDetermined(m, k)))
          best = std::move(m);
      }
    }
  }

  // Of two kinds that explain about as much the one that is usual: a flash, or a lamp that stands far away.
  static int Boldness(const Light& light) {
    return (light.type == LightType::kPoint) != (light.frame == LightFrame::kCamera);
  }

  static int Boldness(const Mixture& m) {
    int sum = 0;
    for (const Light& light : m.lights) sum += Boldness(light);
    return sum;
  }

  std::vector<Light> OtherKinds(const Light& light) const {
    std::vector<Light> others;
    if (light.type == LightType::kDistant && options_.allow_point) {
      for (double diagonals : {1.0, 3.0, 10.0})
        others.push_back(AtDistance(observations_, light, center_, diagonals * diagonal_));
      if (light.frame == LightFrame::kCamera)
        others.push_back({LightType::kPoint, LightFrame::kCamera, Eigen::Vector3d::Zero(), 0});
    } else if (light.type == LightType::kPoint && options_.allow_distant) {
      const Light behind{LightType::kDistant, LightFrame::kCamera, -Eigen::Vector3d::UnitZ(), 0};
      others.push_back(light.frame == LightFrame::kCamera
                           ? behind
                           : Light{LightType::kDistant, light.frame, (light.vector - center_).normalized(), 0});
    }
    return others;
  }

  // A light that could as well be infinitely far is a distant one.
  bool DistanceIsDetermined(const Mixture& m, size_t k) const {
    const FoundLight found = WithCovariance(m, k);
    Eigen::Vector3d away = Eigen::Vector3d::Zero();
    for (const LightObservation& o : observations_)
      away += (found.light.vector - (found.light.frame == LightFrame::kWorld ? center_ : o.cam_from_world * center_)) /
              observations_.size();
    const double distance = away.norm();
    away /= std::max(distance, 1e-12 * diagonal_);
    return distance > 3 * std::sqrt(away.dot(found.covariance * away));
  }

  FoundLight WithCovariance(const Mixture& m, size_t j) const {
    FoundLight out;
    out.light = m.lights[j];
    const Eigen::VectorXd weights = m.weights.col(j);
    out.support = m.responsibilities.col(j).sum();
    out.normal_sigma_deg = m.sigmas[j] / kRadians;
    const Eigen::Matrix3d hessian =
        LineariseLight(observations_, weights, out.light, options_.max_incidence_deg, diagonal_, Prior(m.sigmas[j]))
            .hessian;
    const int p = NumParameters(out.light);
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(hessian.topLeftCorner(p, p));
    const Eigen::VectorXd values = eigen.eigenvalues().cwiseMax(1e-12);
    out.conditioning = values[0] / values[p - 1];
    // Highlights near each other share the error of the surface under them: about four count as one.
    const Eigen::MatrixXd root =
        2 * m.sigmas[j] * eigen.eigenvectors() * values.cwiseSqrt().cwiseInverse().asDiagonal();
    const Eigen::MatrixXd spread = TangentBasis(out.light, diagonal_).leftCols(p) * root;
    out.covariance = spread * spread.transpose();
    const double sigma = 2 * m.sigmas[j] / std::sqrt(values[0]);
    out.light.sigma = p == 2 ? std::min(sigma / kRadians, 90.0) : sigma * diagonal_;
    return out;
  }

  FoundLight Describe(const Mixture& m, size_t j) const {
    FoundLight out = WithCovariance(m, j);
    Mixture without = m;
    without.lights.erase(without.lights.begin() + static_cast<long>(j));
    without.shares.erase(without.shares.begin() + static_cast<long>(j));
    without.sigmas.erase(without.sigmas.begin() + static_cast<long>(j));
    Finish(without);
    out.criterion_gain = without.criterion - m.criterion;
    out.covariance = LightCovariance(observations_, m.responsibilities.col(static_cast<long>(j)), m.sigmas[j],
                                     options_.max_incidence_deg, diagonal_, Prior(m.sigmas[j]), out.light);
    out.light.sigma = LargestSigma(out.covariance, out.light);
    return out;
  }

  const std::vector<LightObservation>& observations_;
  const Eigen::Vector3d center_;
  const double diagonal_;
  const LightFitOptions& options_;
  double flash_spread_ = 0;  // how far from the camera a flash is expected, diagonals
};

LightFit Fitter::Report(const Mixture& m) const {
  LightFit fit;
  const size_t n = observations_.size(), k = m.lights.size();
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

}  // namespace

LightFit FitLights(const std::vector<LightObservation>& observations, const Eigen::Vector3d& center, double diagonal,
                   const LightFitOptions& options) {
  GLINT_CHECK_GT(diagonal, 0);
  LightFitOptions standing = options, moving = options;
  standing.allow_camera = false;
  std::vector<LightObservation> not_paint = observations;
  for (LightObservation& o : not_paint) o.outlier = !o.may_move;
  const Fitter with_standing(observations, center, diagonal, standing),
      with_moving(not_paint, center, diagonal, moving);
  const Mixture m = options.allow_world ? with_standing.Search() : Mixture();
  const Mixture n = options.allow_camera ? with_moving.Search() : Mixture();
  return n.criterion < m.criterion ? with_moving.Report(n) : with_standing.Report(m);
}

}  // namespace glint
