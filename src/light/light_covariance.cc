#include "light/light_covariance.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>

#include "light/light_adjust.h"

namespace glint {
namespace {

constexpr int kWarp = 6;            // coefficients of a symmetric map
constexpr int kParams = 3 + kWarp;  // of the light, of the map
constexpr double kWarpSigma = 0.1;  // prior of each coefficient
constexpr double kFreedom = 3;      // of Student's distribution, as in FitLights()
constexpr double kLeastSigma = 1 * M_PI / 180;
constexpr double kPerMeasurement = 4;  // highlights near each other that count as one
constexpr int kRounds = 5;
using Vector = Eigen::Matrix<double, kParams, 1>;
using Matrix = Eigen::Matrix<double, kParams, kParams>;
using Rows = Eigen::Matrix<double, 3, kParams>;

// How the mapped normal changes with the map's coefficients: those of the diagonal, then xy, xz, yz.
Eigen::Matrix<double, 3, kWarp> WarpJacobian(const Eigen::Vector3d& n) {
  Eigen::Matrix<double, 3, kWarp> change = Eigen::Matrix<double, 3, kWarp>::Zero();
  for (int k = 0; k < 3; ++k) change(k, k) = n[k];
  constexpr int kPairs[3][2] = {{0, 1}, {0, 2}, {1, 2}};
  for (int k = 0; k < 3; ++k) {
    const auto [a, b] = kPairs[k];
    change(a, 3 + k) = n[b];
    change(b, 3 + k) = n[a];
  }
  return (Eigen::Matrix3d::Identity() - n * n.transpose()) * change;
}

class Uncertainty {
 public:
  Uncertainty(const std::vector<LightObservation>& observations, const Eigen::VectorXd& responsibilities, double sigma,
              double max_incidence_deg, double diagonal, double prior, const Light& light)
      : observations_(observations),
        responsibilities_(responsibilities),
        max_incidence_deg_(max_incidence_deg),
        diagonal_(diagonal),
        prior_(prior),
        light_(light),
        sigma_(sigma) {}

  Eigen::Matrix3d Covariance() {
    for (int round = 0; round < kRounds; ++round) {
      Build();
      warp_ -= hessian_.bottomRightCorner<kWarp, kWarp>().ldlt().solve(gradient_.tail<kWarp>());
    }
    Build();
    const Eigen::Matrix3d basis = TangentBasis(light_, diagonal_);
    return basis * InTangents() * basis.transpose();
  }

 private:
  struct Sample {
    Eigen::Vector3d position;
    Vector score;
  };

  // Normal equations, the scores of the observations, and a new sigma.
  void Build() {
    hessian_.setZero();
    gradient_.setZero();
    samples_.clear();
    double squares = 0, total = 0;
    for (size_t i = 0; i < observations_.size(); ++i) {
      const LightObservation& o = observations_[i];
      if (responsibilities_[i] < 1e-3 || Disagreement(o, light_, max_incidence_deg_) > 3) continue;
      Rows rows;
      rows.leftCols<3>() = HalfVectorJacobian(o, light_, diagonal_);
      rows.rightCols<kWarp>() = -WarpJacobian(o.normal);
      const Eigen::Vector3d r =
          HalfVector(light_, o.cam_from_world, o.position) - o.normal + rows.rightCols<kWarp>() * warp_;
      const double weight = responsibilities_[i] * (kFreedom + 2) / (kFreedom + r.squaredNorm() / (sigma_ * sigma_));
      hessian_ += weight * rows.transpose() * rows;
      samples_.push_back({o.position, weight * rows.transpose() * r});
      gradient_ += samples_.back().score;
      squares += weight * r.squaredNorm();
      total += responsibilities_[i];
    }
    // Against priors, too, only so many of the measurements are independent.
    // Of a near light the map would be no more than another distance.
    const double warp_sigma = light_.type == LightType::kDistant ? kWarpSigma : 1e-4;
    const double hold = kPerMeasurement * std::pow(sigma_ / warp_sigma, 2);
    hessian_.diagonal().tail<kWarp>().array() += hold;
    gradient_.tail<kWarp>() += hold * warp_;
    if (light_.type == LightType::kPoint && light_.frame == LightFrame::kCamera) {
      hessian_.diagonal().head<3>().array() += kPerMeasurement * prior_;
    }
    // A distant light has no third coordinate.
    if (light_.type == LightType::kDistant) hessian_(2, 2) += 1;
    if (total > 0) sigma_ = std::max(kLeastSigma, std::sqrt(squares / (2 * total)));
  }

  // Of the light's tangent coordinates.
  Eigen::Matrix3d InTangents() const {
    const Matrix inverse = hessian_.ldlt().solve(Matrix::Identity());
    Eigen::Matrix3d best = kPerMeasurement * sigma_ * sigma_ * inverse.topLeftCorner<3, 3>();
    if (light_.type == LightType::kDistant) best.row(2).setZero(), best.col(2).setZero();
    for (const double reach : {0.05, 0.1, 0.2, 0.4}) {
      Matrix meat = Matrix::Zero();
      for (const Sample& a : samples_)
        for (const Sample& b : samples_) {
          const double d = (a.position - b.position).norm() / (reach * diagonal_);
          if (d < 3) meat += std::exp(-0.5 * d * d) * a.score * b.score.transpose();
        }
      const Eigen::Matrix3d shared = (inverse * meat * inverse).topLeftCorner<3, 3>();
      if (shared.trace() > best.trace()) best = shared;
    }
    return best;
  }

  const std::vector<LightObservation>& observations_;
  const Eigen::VectorXd& responsibilities_;
  const double max_incidence_deg_, diagonal_, prior_;
  const Light light_;
  double sigma_;
  Eigen::Matrix<double, kWarp, 1> warp_ = Eigen::Matrix<double, kWarp, 1>::Zero();
  Matrix hessian_;
  Vector gradient_;
  std::vector<Sample> samples_;
};

}  // namespace

Eigen::Matrix3d LightCovariance(const std::vector<LightObservation>& observations,
                                const Eigen::VectorXd& responsibilities, double sigma, double max_incidence_deg,
                                double diagonal, double prior, const Light& light) {
  return Uncertainty(observations, responsibilities, sigma, max_incidence_deg, diagonal, prior, light).Covariance();
}

double LargestSigma(const Eigen::Matrix3d& covariance, const Light& light) {
  const double largest =
      std::sqrt(std::max(0.0, Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvalues()[2]));
  return light.type == LightType::kPoint ? largest : std::min(largest * 180 / M_PI, 90.0);
}

}  // namespace glint
