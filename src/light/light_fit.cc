#include "light/light_fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/check.h"
#include "core/parallel.h"
#include "light/light_adjust.h"
#include "light/light_covariance.h"
#include "light/light_mixture.h"
#include "light/light_starts.h"

namespace glint {
namespace {

constexpr double kRadians = M_PI / 180;
constexpr double kDecisive = 10;  // Kass, Raftery 1995: "very strong"
constexpr int kStartsOfAKind = 3;

class Fitter {
 public:
  Fitter(const std::vector<LightObservation>& observations, const Eigen::Vector3d& center, double diagonal,
         const LightFitOptions& options)
      : observations_(observations),
        center_(center),
        diagonal_(diagonal),
        options_(options),
        em_(observations, center, diagonal, options) {}

  LightMixture Search() const {
    LightMixture best;
    em_.Finish(best);
    if (observations_.empty()) return best;
    while (static_cast<int>(best.lights.size()) < options_.max_lights) {
      const LightMixture next = WithOneMore(best);
      if (em_.Repeats(next) || !(next.criterion < best.criterion - kDecisive) ||
          next.LeastSupport() < options_.min_support)
        break;
      best = next;
    }
    TryOtherKinds(best);
    return best;
  }

  // Of what is a light in it; that crowds of marks are explained, too, says nothing. Infinite: there is none.
  double CriterionOfLights(LightMixture m) const {
    for (size_t k = m.lights.size(); k-- > 0;)
      if (m.sigmas[k] > options_.max_normal_sigma_deg * kRadians) m.Remove(k);
    if (m.lights.empty()) return std::numeric_limits<double>::infinity();
    em_.Finish(m);
    return m.criterion;
  }

  LightFit Report(const LightMixture& m) const;

 private:
  // The mixture with the best further light of any kind: beside those there are, or one of them made two.
  LightMixture WithOneMore(const LightMixture& base) const {
    Eigen::VectorXd unexplained = Eigen::VectorXd::Ones(observations_.size());
    if (!base.lights.empty()) unexplained -= base.responsibilities.rowwise().sum();
    std::vector<LightMixture> tried;
    for (const Light& start : Starts(unexplained)) tried.emplace_back(base).Add(start);
    for (size_t k = 0; k < base.lights.size(); ++k) {
      const std::vector<Light> modes =
          LikelyDirections(observations_, base.responsibilities.col(k), base.lights[k].frame,
                           options_.max_incidence_deg, kBroadStart, 2);
      if (!options_.allow_distant || modes.size() < 2) continue;
      LightMixture& m = tried.emplace_back(base);
      m.Add(modes[1]);
      m.lights[k] = modes[0];
      m.sigmas[k] = kBroadStart;
      m.shares[k] /= 2;
      m.shares.back() = m.shares[k];
    }
    ParallelFor(tried.size(), 1, [&](size_t t) { em_.Finish(tried[t]); });
    LightMixture best;
    for (LightMixture& m : tried)
      if (Possible(m) && m.criterion + kDecisive * Boldness(m) < best.criterion + kDecisive * Boldness(best))
        best = std::move(m);
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
    for (const double sigma : {2 * kBroadStart, kBroadStart})
      for (const Light& light :
           LikelyDirections(observations_, weights, frame, options_.max_incidence_deg, sigma, kStartsOfAKind))
        starts.push_back(light);
  }

  // Distant lights as near ones, and near ones as distant. A light of the wrong kind catches a part of its highlights
  // only, and that narrowly: the other starts broadly.
  void TryOtherKinds(LightMixture& best) const {
    for (size_t k = 0; k < best.lights.size(); ++k) {
      const Light light = best.lights[k];
      for (const Light& other : OtherKinds(light)) {
        LightMixture m = best;
        m.Replace(k, other);
        em_.Finish(m);
        if (!Possible(m) || m.LeastSupport() < options_.min_support) continue;
        const double margin = kDecisive * (Boldness(other) - Boldness(best.lights[k]));
        const bool better = m.criterion < best.criterion - margin;
        // How well a distance fits is not to be believed where its error, which the criterion does not know, is as
        // large.
        if (IsNear(other) ? better && DistanceIsDetermined(m, k)
                          : better || (IsNear(best.lights[k]) && !DistanceIsDetermined(best, k)))
          best = std::move(m);
      }
    }
  }

  bool Possible(const LightMixture& m) const {
    return !options_.may_be_at || std::all_of(m.lights.begin(), m.lights.end(), [&](const Light& light) {
      return light.type != LightType::kPoint || light.frame != LightFrame::kWorld || options_.may_be_at(light.vector);
    });
  }

  static bool IsNear(const Light& light) { return light.type == LightType::kPoint && !IsFlash(light); }

  // Of two kinds that explain about as much the one that is usual: a flash, or a lamp that stands far away.
  static int Boldness(const Light& light) {
    return (light.type == LightType::kPoint) != (light.frame == LightFrame::kCamera);
  }

  static int Boldness(const LightMixture& m) {
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
  bool DistanceIsDetermined(const LightMixture& m, size_t k) const {
    const Light& light = m.lights[k];
    Eigen::Vector3d away = Eigen::Vector3d::Zero();
    for (const LightObservation& o : observations_)
      away += (light.vector - (light.frame == LightFrame::kWorld ? center_ : o.cam_from_world * center_)) /
              observations_.size();
    const double distance = away.norm();
    away /= std::max(distance, 1e-12 * diagonal_);
    return distance > 3 * std::sqrt(away.dot(CovarianceOf(m, k) * away));
  }

  Eigen::Matrix3d CovarianceOf(const LightMixture& m, size_t k) const {
    return LightCovariance(observations_, m.responsibilities.col(static_cast<long>(k)), m.sigmas[k],
                           options_.max_incidence_deg, diagonal_, em_.Prior(m.sigmas[k]), m.lights[k]);
  }

  // Of the smallest to the largest eigenvalue.
  double Conditioning(const LightMixture& m, size_t j) const {
    const Eigen::VectorXd weights = m.weights.col(static_cast<long>(j));
    const Eigen::Matrix3d hessian = LineariseLight(observations_, weights, m.lights[j], options_.max_incidence_deg,
                                                   diagonal_, em_.Prior(m.sigmas[j]))
                                        .hessian;
    const int p = NumParameters(m.lights[j]);
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(hessian.topLeftCorner(p, p), Eigen::EigenvaluesOnly);
    const Eigen::VectorXd values = eigen.eigenvalues().cwiseMax(1e-12);
    return values[0] / values[p - 1];
  }

  FoundLight Describe(const LightMixture& m, size_t j) const {
    FoundLight out;
    out.light = m.lights[j];
    out.support = m.responsibilities.col(static_cast<long>(j)).sum();
    out.normal_sigma_deg = m.sigmas[j] / kRadians;
    out.conditioning = Conditioning(m, j);
    LightMixture without = m;
    without.Remove(j);
    em_.Finish(without);
    out.criterion_gain = without.criterion - m.criterion;
    out.covariance = CovarianceOf(m, j);
    out.light.sigma = LargestSigma(out.covariance, out.light);
    return out;
  }

  const std::vector<LightObservation>& observations_;
  const Eigen::Vector3d center_;
  const double diagonal_;
  const LightFitOptions& options_;
  const LightMixtureFit em_;
};

LightFit Fitter::Report(const LightMixture& m) const {
  LightFit fit;
  const size_t n = observations_.size(), k = m.lights.size();
  fit.outlier_share = m.OutlierShare();
  std::vector<size_t> order(k);
  for (size_t j = 0; j < k; ++j) order[j] = j;
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) {
    return m.responsibilities.col(a).sum() > m.responsibilities.col(b).sum();
  });
  for (size_t j : order) fit.lights.push_back(Describe(m, j));
  fit.assignment.assign(n, -1);
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
  const LightMixture m = options.allow_world ? with_standing.Search() : LightMixture();
  const LightMixture n = options.allow_camera ? with_moving.Search() : LightMixture();
  const double of_m = with_standing.CriterionOfLights(m), of_n = with_moving.CriterionOfLights(n);
  const bool moves = of_m == of_n ? n.criterion < m.criterion : of_n < of_m;
  return moves ? with_moving.Report(n) : with_standing.Report(m);
}

}  // namespace glint
