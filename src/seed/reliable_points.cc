#include "seed/reliable_points.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "geometry/point_index.h"

namespace glint {
namespace {

constexpr size_t kGrain = 64;
constexpr int kNeighbors = 6;
constexpr int kMaxLines = 24;  // of a track, for the angle: enough to find nearly the widest

// Widest angle (radians) between two lines of sight of the point.
double WidestAngle(const ScenePoint& point, const std::vector<Eigen::Vector3d>& centers) {
  std::vector<Eigen::Vector3d> rays;
  const size_t n = point.observations.size();
  const size_t stride = std::max<size_t>(1, (n + kMaxLines - 1) / kMaxLines);
  for (size_t i = 0; i < n; i += stride)
    rays.push_back((centers[point.observations[i].view] - point.position).normalized());
  double widest = 0;
  for (size_t i = 0; i < rays.size(); ++i)
    for (size_t j = i + 1; j < rays.size(); ++j)
      widest = std::max(widest, std::atan2(rays[i].cross(rays[j]).norm(), rays[i].dot(rays[j])));
  return widest;
}

// Standard deviation of the triangulated position along its least certain direction.
double PositionSigma(const ScenePoint& point, const Scene& scene, const std::vector<Eigen::Vector3d>& centers,
                     double angle) {
  double world_per_px = 0;
  for (const Observation& o : point.observations) {
    const double focal = MeanFocalLength(scene.views[o.view].camera);
    world_per_px += (centers[o.view] - point.position).norm() / focal;
  }
  world_per_px /= static_cast<double>(std::max<size_t>(1, point.observations.size()));
  const double error = point.error_px > 0 ? point.error_px : 1.0;
  return error * world_per_px / std::max(std::sin(std::min(angle, M_PI / 2)), 1e-3);
}

// A point is isolated if its neighbours are much farther than theirs are from each other. Points far out are many times
// farther from anything than their neighbours; a lone mark on a glossy body is only a few times.
void MarkIsolated(const Scene& scene, double max_isolation, std::vector<PointStatus>& status) {
  std::vector<int> used;
  std::vector<Eigen::Vector3d> positions;
  for (size_t i = 0; i < status.size(); ++i)
    if (status[i] == PointStatus::kReliable) {
      used.push_back(static_cast<int>(i));
      positions.push_back(scene.points[i].position);
    }
  if (positions.size() <= 2 * size_t{kNeighbors}) return;
  const PointIndex index(positions);
  std::vector<std::vector<int>> neighbors(positions.size());
  std::vector<double> spacing(positions.size());
  ParallelFor(positions.size(), kGrain, [&](size_t i) {
    neighbors[i] = index.Nearest(positions[i], kNeighbors + 1);
    spacing[i] = (positions[neighbors[i].back()] - positions[i]).norm();
  });
  for (size_t i = 0; i < positions.size(); ++i) {
    std::vector<double> around;
    for (int n : neighbors[i]) around.push_back(spacing[n]);
    std::nth_element(around.begin(), around.begin() + around.size() / 2, around.end());
    if (spacing[i] > max_isolation * around[around.size() / 2]) status[used[i]] = PointStatus::kIsolated;
  }
}

}  // namespace

void ReliabilityOptions::Visit(OptionVisitor& v) {
  v.Field({.name = "min_track_length", .help = "Fewest images that must see a sparse point", .min = 2, .max = 100},
          min_track_length);
  v.Field({.name = "max_error_px", .help = "Largest mean reprojection error", .unit = "px", .min = 0.1, .max = 100},
          max_error_px);
  v.Field({.name = "min_angle_deg", .help = "Smallest triangulation angle", .unit = "deg", .min = 0, .max = 90},
          min_angle_deg);
  v.Field({.name = "max_isolation",
           .help = "A point farther from its neighbours than this is dropped",
           .unit = "times the spacing around it",
           .min = 1,
           .max = 1e6},
          max_isolation);
}

std::vector<uint8_t> PointReliability::ReliableMask() const {
  std::vector<uint8_t> mask(status.size());
  for (size_t i = 0; i < mask.size(); ++i) mask[i] = status[i] == PointStatus::kReliable;
  return mask;
}

size_t PointReliability::Count(PointStatus s) const { return std::count(status.begin(), status.end(), s); }

PointReliability JudgePoints(const Scene& scene, const ReliabilityOptions& options) {
  std::vector<Eigen::Vector3d> centers;
  for (const View& view : scene.views) centers.push_back(view.Center());
  PointReliability out;
  out.status.assign(scene.points.size(), PointStatus::kReliable);
  out.sigma.assign(scene.points.size(), 0);
  const double min_angle = options.min_angle_deg * M_PI / 180;
  ParallelFor(scene.points.size(), kGrain, [&](size_t i) {
    const ScenePoint& point = scene.points[i];
    const double angle = WidestAngle(point, centers);
    out.sigma[i] = PositionSigma(point, scene, centers, angle);
    if (point.observations.size() < static_cast<size_t>(options.min_track_length))
      out.status[i] = PointStatus::kShortTrack;
    else if (point.error_px > options.max_error_px)
      out.status[i] = PointStatus::kLargeError;
    else if (angle < min_angle)
      out.status[i] = PointStatus::kNarrowAngle;
  });
  MarkIsolated(scene, options.max_isolation, out.status);
  return out;
}

}  // namespace glint
