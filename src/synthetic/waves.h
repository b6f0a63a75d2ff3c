// Sums of plane sine waves, the stuff of free-form shapes.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <numbers>

#include "core/check.h"
#include "synthetic/random.h"

namespace glint {

// sin(x) to 1e-11 for |x| < 1e5; the compiler turns loops over it into vector code, unlike std::sin.
inline double FastSine(double x) {
  // Adding and taking away 1.5 · 2^52 rounds to an integer.
  constexpr double kRound = 6755399441055744.0;
  const double half_turns = (x * std::numbers::inv_pi + kRound) - kRound;
  const double parity = half_turns - 2 * ((half_turns * 0.5 + kRound) - kRound);  // 0 or ±1
  const double r = x - half_turns * std::numbers::pi, r2 = r * r;
  // Taylor's series of the sine on [-π/2, π/2].
  double sum = -1.0 / 1307674368000.0;
  sum = sum * r2 + 1.0 / 6227020800.0;
  sum = sum * r2 - 1.0 / 39916800.0;
  sum = sum * r2 + 1.0 / 362880.0;
  sum = sum * r2 - 1.0 / 5040.0;
  sum = sum * r2 + 1.0 / 120.0;
  sum = sum * r2 - 1.0 / 6.0;
  return (1 - 2 * parity * parity) * (r + r * r2 * sum);
}

// Up to eight waves, kept as a structure of arrays for vector code.
class Waves {
 public:
  Waves() = default;

  // `slope`: amplitude times wave number of each wave. `flat`: no wave runs along z.
  Waves(Random& random, int count, double min_number, double max_number, double slope, bool flat) {
    GLINT_CHECK_LE(count, kMax);
    for (int i = 0; i < count; ++i) {
      const double number = random.Uniform(min_number, max_number);
      Eigen::Vector3d k = random.UnitVector();
      if (flat) k.z() = 0;
      k *= number / k.norm();
      kx_[i] = k.x(), ky_[i] = k.y(), kz_[i] = k.z();
      amplitude_[i] = slope / number;
      phase_[i] = random.Uniform(0, 2 * std::numbers::pi);
      slope_bound_ += slope;
      amplitude_bound_ += slope / number;
    }
    used_ = (count + 1) / 2 * 2;
  }

  double Value(const Eigen::Vector3d& x) const {
    double terms[kMax];
    for (int i = 0; i < used_; ++i)
      terms[i] = amplitude_[i] * FastSine(kx_[i] * x.x() + ky_[i] * x.y() + kz_[i] * x.z() + phase_[i]);
    double sum = 0;
    for (int i = 0; i < used_; ++i) sum += terms[i];
    return sum;
  }

  Eigen::Vector3d Gradient(const Eigen::Vector3d& x) const {
    double terms[kMax];
    for (int i = 0; i < used_; ++i)
      terms[i] = amplitude_[i] *
                 FastSine(kx_[i] * x.x() + ky_[i] * x.y() + kz_[i] * x.z() + phase_[i] + 0.5 * std::numbers::pi);
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (int i = 0; i < used_; ++i) sum += terms[i] * Eigen::Vector3d(kx_[i], ky_[i], kz_[i]);
    return sum;
  }

  double slope_bound() const { return slope_bound_; }
  double amplitude_bound() const { return amplitude_bound_; }

 private:
  static constexpr int kMax = 8;
  using Numbers = std::array<double, kMax>;
  Numbers kx_ = {}, ky_ = {}, kz_ = {}, amplitude_ = {}, phase_ = {};
  int used_ = 0;  // even: an odd count has a wave without amplitude
  double slope_bound_ = 0, amplitude_bound_ = 0;
};

}  // namespace glint
