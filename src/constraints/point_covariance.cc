#include "constraints/point_covariance.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/check.h"
#include "core/median.h"
#include "core/parallel.h"

namespace glint {
namespace {

constexpr double kLeastSigmaPx = 0.1;  // nobody localises better, whatever few residuals say
// The median of all counts as much as this many degrees of freedom of a point's own.
constexpr double kPriorFreedom = 4;
// A direction that the rays do not fix is known this many times less well than the one they fix best.
constexpr double kMaxSigmaRatio = 1e3;

struct Triangulation {
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();  // for a standard deviation of one pixel
  double squared_residual = 0;                            // px²
  int freedom = 0;
};

Triangulation Triangulate(const Scene& scene, const ScenePoint& point) {
  Triangulation t;
  int observations = 0;
  for (const Observation& o : point.observations) {
    const View& view = scene.views[o.view];
    const auto px = view.Project(point.position);
    if (!px) continue;
    const Eigen::Vector3d ray = point.position - view.Center();
    const double px_per_length = MeanFocalLength(view.camera) / ray.norm();
    const Eigen::Vector3d d = ray.normalized();
    t.information += px_per_length * px_per_length * (Eigen::Matrix3d::Identity() - d * d.transpose());
    t.squared_residual += (*px - o.px.cast<double>()).squaredNorm();
    ++observations;
  }
  t.freedom = std::max(0, 2 * observations - 3);
  return t;
}

Eigen::Matrix3d Inverse(const Eigen::Matrix3d& information) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(information);
  const double most = eigen.eigenvalues()[2];
  if (!(most > 0)) return Eigen::Matrix3d::Zero();
  const Eigen::Vector3d kept = eigen.eigenvalues().cwiseMax(most / (kMaxSigmaRatio * kMaxSigmaRatio));
  return eigen.eigenvectors() * kept.cwiseInverse().asDiagonal() * eigen.eigenvectors().transpose();
}

}  // namespace

std::vector<Eigen::Matrix3d> PointCovariances(const Scene& scene, const std::vector<uint8_t>& used) {
  GLINT_CHECK_EQ(used.size(), scene.points.size());
  std::vector<Triangulation> triangulations(used.size());
  ParallelFor(used.size(), 1 << 10, [&](size_t i) {
    if (used[i]) triangulations[i] = Triangulate(scene, scene.points[i]);
  });
  std::vector<double> variances;
  for (const Triangulation& t : triangulations)
    if (t.freedom > 0) variances.push_back(t.squared_residual / t.freedom);
  const double common = Median(std::move(variances));
  std::vector<Eigen::Matrix3d> covariances(used.size(), Eigen::Matrix3d::Zero());
  ParallelFor(used.size(), 1 << 10, [&](size_t i) {
    if (!used[i]) return;
    const Triangulation& t = triangulations[i];
    const double variance = (kPriorFreedom * common + t.squared_residual) / (kPriorFreedom + t.freedom);
    covariances[i] = std::max(variance, kLeastSigmaPx * kLeastSigmaPx) * Inverse(t.information);
  });
  return covariances;
}

}  // namespace glint
