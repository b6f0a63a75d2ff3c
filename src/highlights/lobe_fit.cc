#include "highlights/lobe_fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "highlights/lobe_minimise.h"

namespace glint {
namespace {

using internal::kNumLobeParams;
using internal::LobeMinimum;
using internal::LobeProblem;
using internal::LobeSamples;

constexpr double kHalfHeightQ = 0.41421356;  // (1 + q)^-2 = 1/2
constexpr double kReach = 3.4;               // radius of the fit in standard deviations of the blob (half height: 2)
constexpr double kManyPixels = 160;          // fix ten parameters well
constexpr double kMostSaturated = 0.05;      // else only a thin rim is left to judge by
constexpr double kPerMeasurement = 4;        // residuals of neighbouring pixels go together (blur, JPEG, shape)

// One of so many pixels is looked at.
int Stride(const Eigen::Matrix2d& shape) {
  const double area = M_PI * kReach * kReach * std::sqrt(shape.determinant());
  return std::max(1, static_cast<int>(std::ceil(area / kManyPixels)));
}

// The pixels within an ellipse somewhat larger than the blob.
void Gather(const cv::Mat& map, const cv::Mat& mask, const Eigen::Vector2d& centroid, const Eigen::Matrix2d& shape,
            int stride, LobeSamples& samples) {
  const Eigen::Matrix2d inverse = shape.inverse();
  const double ry = kReach * std::sqrt(shape(1, 1));
  const int y0 = std::max(0, static_cast<int>(std::ceil(centroid.y() - ry)));
  const int y1 = std::min(map.rows - 1, static_cast<int>(std::floor(centroid.y() + ry)));
  // Spread like the knights of a chessboard.
  const int turn = static_cast<int>(std::lround(0.382 * stride));
  for (int y = y0; y <= y1; ++y) {
    const double dy = y - centroid.y();
    const double middle = centroid.x() - inverse(0, 1) / inverse(0, 0) * dy;
    const double half = std::sqrt(std::max(0.0, (kReach * kReach - dy * dy / shape(1, 1)) / inverse(0, 0)));
    const int x0 = std::max(0, static_cast<int>(std::ceil(middle - half)));
    const int x1 = std::min(map.cols - 1, static_cast<int>(std::floor(middle + half)));
    const uint16_t* row = map.ptr<uint16_t>(y);
    const uint8_t* in_mask = mask.empty() ? nullptr : mask.ptr<uint8_t>(y);
    for (int x = x0 + (stride - x0 % stride + y % stride * turn) % stride; x <= x1; x += stride)
      if (!in_mask || in_mask[x])
        samples.Add(static_cast<float>(x - centroid.x()), static_cast<float>(dy), row[x] * (1 / 65535.f));
  }
}

// Where the fit begins: the blob as an upright lobe.
internal::LobeParams Start(LobeProblem& problem, const Eigen::Matrix2d& moments) {
  const Eigen::Matrix2d q = kHalfHeightQ / 4 * (moments + 0.1 * Eigen::Matrix2d::Identity()).inverse();
  const double a = std::sqrt(q(0, 0)), c = q(0, 1) / a, e = std::sqrt(std::max(q(1, 1) - c * c, 1e-9));
  internal::LobeParams p = internal::LobeParams::Zero();
  p[internal::kLogAmplitude] = std::log(problem.rise) + (problem.samples.saturated_count > 0 ? 0.7f : 0.1f);
  p[internal::kBody] = problem.body_prior;
  p[internal::kA] = static_cast<float>(a), p[internal::kC] = static_cast<float>(c);
  p[internal::kE] = static_cast<float>(e);
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes;
  const Eigen::Vector2d major = axes.computeDirect(moments).eigenvectors().col(1);
  problem.samples.long_axis = Eigen::Vector2d(a * major.x() + c * major.y(), e * major.y()).normalized().cast<float>();
  return p;
}

}  // namespace

LobeFit FitLobe(const cv::Mat& map, const cv::Mat& mask, const Eigen::Vector2d& centroid,
                const Eigen::Matrix2d& moments, double body, double peak_value, double saturation,
                double max_profile_error) {
  LobeFit fit;
  LobeProblem problem;
  LobeSamples& samples = problem.samples;
  const double rise = peak_value - body;
  const Eigen::Matrix2d shape = moments + 0.25 * Eigen::Matrix2d::Identity();
  const int stride = Stride(shape);
  Gather(map, mask, centroid, shape, stride, samples);
  samples.Finish(static_cast<float>(body), static_cast<float>(0.004 + 0.01 * rise), 0.03f,
                 static_cast<float>(saturation));
  if (samples.count < samples.saturated_count + kNumLobeParams + 1) return fit;
  problem.body_prior = static_cast<float>(body);
  problem.body_sigma = static_cast<float>(0.15 * rise + 0.01);
  problem.rise = static_cast<float>(rise);
  const double saturated_fraction = double(samples.saturated_count) / samples.count;
  const bool is_judged = saturated_fraction < kMostSaturated;
  if (is_judged) problem.max_profile_error = static_cast<float>(max_profile_error);
  LobeMinimum minimum;
  minimum.p = Start(problem, moments);
  if (!MinimiseLobe(problem, minimum)) return fit;

  const Eigen::Vector2d moved = minimum.p.segment<2>(internal::kPeakX).cast<double>();
  if (moved.dot(shape.inverse() * moved) > 9) return fit;
  const auto covariance = PeakCovariance(minimum.equations);
  if (!covariance) return fit;

  fit.ok = true;
  fit.peak = centroid + moved;
  fit.covariance = std::max(1.0, kPerMeasurement / stride) * minimum.scale * minimum.scale * *covariance;
  fit.profile_error = is_judged ? minimum.profile_error : 0;
  fit.saturated_fraction = saturated_fraction;
  return fit;
}

}  // namespace glint
