#include "light/light_mixture.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/check.h"
#include "core/square.h"
#include "light/light_adjust.h"

namespace glint {
namespace {

constexpr double kRadians = M_PI / 180;
constexpr double kOutlierDensity = 1 / (2 * M_PI);  // normals anywhere on the hemisphere that faces the camera
constexpr double kFreedom = 3;                      // of Student's distribution of the normals' errors
constexpr double kNever = 3;                        // radians; see Disagreement()
constexpr double kMinSigma = 2 * kRadians, kMaxSigma = 6 * kRadians;
constexpr double kMinSeparation = 10 * kRadians;
constexpr double kFirstShare = 0.6;  // of what no light explains yet
constexpr int kEmRounds = 30;
// How far from the camera a flash is expected, as a share of the distance to the object.
constexpr double kFlashSpread = 0.15;

}  // namespace

double LightMixture::OutlierShare() const { return 1 - std::accumulate(shares.begin(), shares.end(), 0.0); }

double LightMixture::LeastSupport() const { return responsibilities.colwise().sum().minCoeff(); }

void LightMixture::Add(const Light& light) {
  lights.push_back(light);
  shares.push_back(kFirstShare * std::max(OutlierShare(), 0.02));
  sigmas.push_back(kBroadStart);
}

void LightMixture::Replace(size_t k, const Light& light) {
  lights[k] = light;
  shares[k] += kFirstShare * std::max(OutlierShare(), 0.0);
  sigmas[k] = std::max(sigmas[k], kBroadStart);
}

void LightMixture::Remove(size_t k) {
  lights.erase(lights.begin() + static_cast<long>(k));
  shares.erase(shares.begin() + static_cast<long>(k));
  sigmas.erase(sigmas.begin() + static_cast<long>(k));
}

LightMixtureFit::LightMixtureFit(const std::vector<LightObservation>& observations, const Eigen::Vector3d& center,
                                 double diagonal, const LightFitOptions& options)
    : observations_(observations), center_(center), diagonal_(diagonal), options_(options) {
  for (const LightObservation& o : observations) {
    num_eligible_ += o.outlier ? 0 : 1;
    flash_spread_ += kFlashSpread * (o.cam_from_world * center).norm() / diagonal / observations.size();
  }
}

void LightMixtureFit::Finish(LightMixture& m) const {
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

bool LightMixtureFit::Repeats(const LightMixture& m) const {
  for (size_t j = 0; j < m.lights.size(); ++j)
    for (size_t k = 0; k < j; ++k)
      if (MeanAngle(m.lights[j], m.lights[k]) < std::max(kMinSeparation, 4 * std::max(m.sigmas[j], m.sigmas[k])))
        return true;
  return false;
}

double LightMixtureFit::MeanAngle(const Light& one, const Light& other) const {
  double angle = 0;
  for (const LightObservation& o : observations_) {
    const Eigen::Vector3d a = DirectionToLight(one, o.cam_from_world, center_);
    const Eigen::Vector3d b = DirectionToLight(other, o.cam_from_world, center_);
    angle += std::atan2(a.cross(b).norm(), a.dot(b)) / observations_.size();
  }
  return angle;
}

// What a light costs: its share, its sigma and its parameters. A flash is where one expects it, and that is worth two
// of them.
double LightMixtureFit::Complexity(const Light& light) const {
  const double log_n = std::log(std::max<double>(num_eligible_, 2));
  if (!IsFlash(light)) return (2 + NumParameters(light)) * log_n;
  return 3 * log_n + (light.vector / (flash_spread_ * diagonal_)).squaredNorm();
}

double LightMixtureFit::Prior(double sigma) const { return Square(sigma / flash_spread_); }

double LightMixtureFit::Expect(LightMixture& m) const {
  const size_t n = observations_.size(), k = m.lights.size();
  m.responsibilities.resize(n, k);
  m.weights.resize(n, k);
  const double outliers = m.OutlierShare();
  double log_likelihood = 0;
  for (size_t i = 0; i < n; ++i) {
    // What is an outlier in any case says nothing of how many there are.
    double total = (observations_[i].outlier ? 1 : outliers) * kOutlierDensity;
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

void LightMixtureFit::Maximise(LightMixture& m) const {
  const size_t n = observations_.size(), k = m.lights.size();
  for (size_t j = 0; j < k; ++j) {
    double squares = 0, weight = 0;
    m.shares[j] = std::clamp(m.responsibilities.col(j).sum() / std::max(num_eligible_, 1.0), 1e-3, 0.98);
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

}  // namespace glint
