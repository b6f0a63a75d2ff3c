#include "colmap/distortion.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace glint::internal {
namespace {

// Highest degree of N D + 2 s (N' D - N D').
constexpr int kMaxSlopeDegree = Lens::kMaxDegree + 3;
using Polynomial = std::array<double, kMaxSlopeDegree + 1>;

template <size_t n>
double Evaluate(const std::array<double, n>& c, double s) {
  double value = 0;
  for (size_t i = n; i-- > 0;) value = value * s + c[i];
  return value;
}

template <size_t n>
double Derivative(const std::array<double, n>& c, double s) {
  double value = 0;
  for (size_t i = n; i-- > 1;) value = value * s + static_cast<double>(i) * c[i];
  return value;
}

// True if the polynomial given by its Bernstein coefficients on an interval is positive there. A polynomial lies in
// the convex hull of its Bernstein coefficients, and de Casteljau's halving makes the hull tight.
bool PositiveBernstein(const Polynomial& b, int depth) {
  if (b.front() <= 0 || b.back() <= 0) return false;
  if (*std::min_element(b.begin(), b.end()) > 0) return true;
  if (depth == 0) return false;  // touches zero within rounding
  Polynomial left, right = b;
  for (int i = 0; i <= kMaxSlopeDegree; ++i) {
    left[i] = right[0];
    for (int j = 0; j + i < kMaxSlopeDegree; ++j) right[j] = 0.5 * (right[j] + right[j + 1]);
  }
  return PositiveBernstein(left, depth - 1) && PositiveBernstein(right, depth - 1);
}

// True if the polynomial is positive on [0, s_max].
bool PositiveUpTo(const Polynomial& c, double s_max) {
  Polynomial scaled;
  double lower_bound = 0, power = 1;
  for (int i = 0; i <= kMaxSlopeDegree; ++i, power *= s_max) {
    scaled[i] = c[i] == 0 ? 0 : c[i] * power;
    lower_bound += i == 0 ? c[0] : std::min(scaled[i], 0.0);
  }
  if (lower_bound > 0) return true;  // every mild distortion ends here
  Polynomial bernstein = {};
  for (int j = 0; j <= kMaxSlopeDegree; ++j) {
    double ratio = 1;  // binomial(j, i) / binomial(degree, i)
    for (int i = 0; i <= j; ++i) {
      bernstein[j] += ratio * scaled[i];
      ratio *= static_cast<double>(j - i) / (kMaxSlopeDegree - i);
    }
  }
  return PositiveBernstein(bernstein, 24);
}

// The radius r N/D grows with r on [0, sqrt(s_max)]: D and the slope's numerator are positive there.
bool MonotoneUpTo(const Lens& lens, double s_max) {
  Polynomial slope = {}, denominator = {};
  for (int j = 0; j < static_cast<int>(lens.denominator.size()); ++j) {
    denominator[j] = lens.denominator[j];
    if (lens.denominator[j] == 0) continue;
    for (int i = 0; i <= Lens::kMaxDegree; ++i) {
      slope[i + j] += lens.numerator[i] * lens.denominator[j] * (1 + 2 * i - 2 * j);
    }
  }
  return PositiveUpTo(denominator, s_max) && PositiveUpTo(slope, s_max);
}

double RadialFactor(const Lens& lens, double s) { return Evaluate(lens.numerator, s) / Evaluate(lens.denominator, s); }

Eigen::Vector2d DistortWithJacobian(const Lens& lens, const Eigen::Vector2d& x, Eigen::Matrix2d& jacobian) {
  const double s = x.squaredNorm();
  const double n = Evaluate(lens.numerator, s), d = Evaluate(lens.denominator, s);
  const double slope = (Derivative(lens.numerator, s) * d - n * Derivative(lens.denominator, s)) / (d * d);
  const Eigen::Vector2d radial = x * (n / d);
  const Eigen::Matrix2d radial_jacobian = Eigen::Matrix2d::Identity() * (n / d) + 2 * slope * x * x.transpose();

  const Eigen::Vector2d b = lens.decenters_distorted ? radial : x;
  const double t = b.squaredNorm(), bxy = 2 * b.x() * b.y();
  const double sx = lens.sx1 + lens.sx2 * t, sy = lens.sy1 + lens.sy2 * t;
  const double dsx = 2 * (lens.sx1 + 2 * lens.sx2 * t), dsy = 2 * (lens.sy1 + 2 * lens.sy2 * t);
  const Eigen::Vector2d shift(lens.p1 * bxy + lens.p2 * (t + 2 * b.x() * b.x()) + sx * t,
                              lens.p2 * bxy + lens.p1 * (t + 2 * b.y() * b.y()) + sy * t);
  Eigen::Matrix2d shift_jacobian;
  const double across_x = 2 * (lens.p1 * b.x() + lens.p2 * b.y());
  shift_jacobian << 2 * lens.p1 * b.y() + 6 * lens.p2 * b.x() + dsx * b.x(), across_x + dsx * b.y(),
      across_x + dsy * b.x(), 2 * lens.p2 * b.x() + 6 * lens.p1 * b.y() + dsy * b.y();

  jacobian = radial_jacobian;
  if (lens.decenters_distorted) {
    jacobian += shift_jacobian * radial_jacobian;
  } else {
    jacobian += shift_jacobian;
  }
  return radial + shift;
}

bool InRange(const Lens& lens, const Eigen::Vector2d& x, const Eigen::Matrix2d& jacobian) {
  return jacobian.determinant() > 0 && MonotoneUpTo(lens, x.squaredNorm());
}

// Newton's method from `x`; nullopt unless it ends in the one-to-one range with the equation satisfied.
std::optional<Eigen::Vector2d> Newton(const Lens& lens, const Eigen::Vector2d& distorted, Eigen::Vector2d x) {
  constexpr int kMaxIterations = 30;
  const double scale = 1 + distorted.norm();
  Eigen::Matrix2d jacobian;
  Eigen::Vector2d residual = DistortWithJacobian(lens, x, jacobian) - distorted;
  for (int i = 0; i < kMaxIterations; ++i) {
    const double determinant = jacobian.determinant();
    if (!(std::abs(determinant) > 1e-12)) return std::nullopt;
    const Eigen::Vector2d step = jacobian.inverse() * residual;
    x -= step;
    residual = DistortWithJacobian(lens, x, jacobian) - distorted;
    if (!residual.allFinite()) return std::nullopt;
    if (step.norm() <= 4e-16 * scale) break;
  }
  if (residual.norm() > 1e-13 * scale || !InRange(lens, x, jacobian)) return std::nullopt;
  return x;
}

// Largest radius up to `limit` within which the radial part is monotone.
double MonotoneRadius(const Lens& lens, double limit) {
  if (MonotoneUpTo(lens, limit * limit)) return limit;
  double low = 0, high = limit;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (MonotoneUpTo(lens, middle * middle) ? low : high) = middle;
  }
  return low;
}

}  // namespace

Lens MakeLens(CameraModel model, const double* k) {
  Lens lens;
  const auto radial = [&](std::initializer_list<int> indices) {
    int i = 1;
    for (const int index : indices) lens.numerator[i++] = k[index];
  };
  switch (model) {
    case CameraModel::kSimpleRadial:
    case CameraModel::kSimpleRadialFisheye:
      radial({0});
      break;
    case CameraModel::kRadial:
    case CameraModel::kRadialFisheye:
      radial({0, 1});
      break;
    case CameraModel::kOpenCV:
      radial({0, 1});
      lens.p1 = k[2], lens.p2 = k[3];
      break;
    case CameraModel::kOpenCVFisheye:
      radial({0, 1, 2, 3});
      break;
    case CameraModel::kFullOpenCV:
      radial({0, 1, 4});
      lens.denominator = {1, k[5], k[6], k[7]};
      lens.p1 = k[2], lens.p2 = k[3];
      break;
    case CameraModel::kThinPrismFisheye:
      radial({0, 1, 4, 5});
      lens.p1 = k[2], lens.p2 = k[3], lens.sx1 = k[6], lens.sy1 = k[7];
      break;
    case CameraModel::kRadTanThinPrismFisheye:
      radial({0, 1, 2, 3, 4, 5});
      // fisheye624 counts its tangential pair the other way round.
      lens.p1 = k[7], lens.p2 = k[6];
      lens.sx1 = k[8], lens.sx2 = k[9], lens.sy1 = k[10], lens.sy2 = k[11];
      lens.decenters_distorted = true;
      break;
    default:
      break;
  }
  return lens;
}

std::optional<Eigen::Vector2d> Distort(const Lens& lens, const Eigen::Vector2d& x) {
  Eigen::Matrix2d jacobian;
  const Eigen::Vector2d distorted = DistortWithJacobian(lens, x, jacobian);
  if (!InRange(lens, x, jacobian)) return std::nullopt;
  return distorted;
}

std::optional<Eigen::Vector2d> Undistort(const Lens& lens, const Eigen::Vector2d& distorted) {
  if (auto x = Newton(lens, distorted, distorted)) return x;
  // Far from the axis Newton may leave the range: invert the radial part alone by bisection and start there.
  const double target = distorted.norm();
  double limit = std::max(target, 1e-3);
  const auto radius = [&](double r) { return r * RadialFactor(lens, r * r); };
  for (int i = 0; i < 14 && radius(limit) < target && MonotoneUpTo(lens, limit * limit); ++i) limit *= 2;
  double low = 0, high = MonotoneRadius(lens, limit);
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (radius(middle) < target ? low : high) = middle;
  }
  if (target == 0 || low == 0) return std::nullopt;
  return Newton(lens, distorted, distorted * (low / target));
}

}  // namespace glint::internal
