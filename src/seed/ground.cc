#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <set>

#include "core/check.h"
#include "core/square.h"
#include "seed/scene_layout.h"

namespace glint {
namespace {

using Plane = Eigen::Hyperplane<double, 3>;

constexpr double kVoxelRel = 0.02;    // of the focus distance: one point a voxel counts
constexpr double kBelowRel = 0.036;   // of the focus distance: lower than this is below
constexpr double kMaxBelow = 0.08;    // share of the points that may lie below
constexpr double kMarginRel = 0.024;  // of the focus distance: cameras are at least so far above
// How near to the plane its points lie, of the focus distance, and how many and what share of all there must be.
struct Flatness {
  double tolerance_rel, min_points, min_share;
};
// A floor whose points lie on one plane is told from the flanks of a low object by that, and few are enough; rougher
// ground has to be told without. Where both find the same plane, it is that of the rough one's many points.
constexpr Flatness kFlat = {0.003, 10, 0.06}, kRough = {0.012, 15, 0.12};
constexpr double kSameDeg = 0.5;
constexpr int kTrials = 3000;
constexpr int kSectors = 12;

// One point a voxel within the focus distance: dense texture must not outvote space.
std::vector<Eigen::Vector3d> ThinnedPoints(const Scene& scene, const std::vector<uint8_t>& use, const Focus& focus) {
  std::vector<Eigen::Vector3d> points;
  std::set<std::array<int64_t, 3>> taken;
  for (size_t i = 0; i < scene.points.size(); ++i) {
    const Eigen::Vector3d x = (scene.points[i].position - focus.center) / focus.distance;
    if (!use[i] || !(x.norm() < 1)) continue;
    std::array<int64_t, 3> voxel;
    for (int k = 0; k < 3; ++k) voxel[k] = static_cast<int64_t>(std::floor(x[k] / kVoxelRel));
    if (taken.insert(voxel).second) points.push_back(scene.points[i].position);
  }
  return points;
}

// Turns the plane so that most cameras are above; false unless nearly all of them are.
bool CamerasAbove(const std::vector<Eigen::Vector3d>& cameras, double margin, Plane& plane) {
  size_t above = 0, below = 0;
  for (const Eigen::Vector3d& c : cameras) {
    const double d = plane.signedDistance(c);
    above += d > margin;
    below += d < -margin;
  }
  if (below > above) {
    std::swap(above, below);
    plane.coeffs() = -plane.coeffs();
  }
  return above >= 0.95 * static_cast<double>(cameras.size());
}

// Points on the plane, each counting less the farther it is off (MSAC, Torr and Zisserman 2000): the ground is flatter
// than the tolerance, and what else has as many points near a plane, as a low object's flanks do, is not. Points below
// speak against it, twice; 0 if too many do.
double Support(const std::vector<Eigen::Vector3d>& points, const Plane& plane, double tolerance, double below_limit) {
  double on = 0;
  size_t below = 0;
  for (const Eigen::Vector3d& p : points) {
    const double d = plane.signedDistance(p);
    on += std::max(0.0, 1 - Square(d / tolerance));
    below += d < -below_limit;
  }
  return static_cast<double>(below) > kMaxBelow * static_cast<double>(points.size())
             ? 0
             : on - 2 * static_cast<double>(below);
}

Plane FitPlane(const std::vector<Eigen::Vector3d>& points, const Plane& from, double tolerance) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  std::vector<Eigen::Vector3d> on;
  for (const Eigen::Vector3d& p : points)
    if (from.absDistance(p) < tolerance) on.push_back(p);
  for (const Eigen::Vector3d& p : on) mean += p / static_cast<double>(on.size());
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& p : on) scatter += (p - mean) * (p - mean).transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(scatter);
  Eigen::Vector3d normal = eigen.eigenvectors().col(0);
  if (normal.dot(from.normal()) < 0) normal = -normal;
  return Plane(normal, mean);
}

// Three robust standard deviations of the points about the plane, within sensible limits.
double Spread(const std::vector<Eigen::Vector3d>& points, const Plane& plane, const Focus& focus) {
  const double tolerance = kRough.tolerance_rel * focus.distance;
  std::vector<double> distances;
  for (const Eigen::Vector3d& p : points)
    if (plane.absDistance(p) < tolerance) distances.push_back(plane.absDistance(p));
  if (distances.empty()) return tolerance;
  std::nth_element(distances.begin(), distances.begin() + distances.size() / 2, distances.end());
  return std::clamp(3 * 1.4826 * distances[distances.size() / 2], 0.1 * tolerance, tolerance);
}

// The plane must reach round below the focus: points on it in most directions from the foot of the focus.
bool Surrounds(const std::vector<Eigen::Vector3d>& points, const Plane& plane, double tolerance, const Focus& focus) {
  const Eigen::Vector3d foot = plane.projection(focus.center);
  const Eigen::Vector3d u = plane.normal().unitOrthogonal(), v = plane.normal().cross(u);
  std::set<int> sectors;
  for (const Eigen::Vector3d& p : points) {
    if (plane.absDistance(p) > tolerance) continue;
    const double angle = std::atan2((p - foot).dot(v), (p - foot).dot(u));
    sectors.insert(std::min(kSectors - 1, static_cast<int>((angle + M_PI) / (2 * M_PI) * kSectors)));
  }
  return sectors.size() >= kSectors * 2 / 3;
}

// The plane that most points lie on within the tolerance.
std::optional<GroundPlane> FindPlane(const std::vector<Eigen::Vector3d>& points,
                                     const std::vector<Eigen::Vector3d>& cameras, const Focus& focus,
                                     const Flatness& flatness) {
  const double tolerance = flatness.tolerance_rel * focus.distance, below = kBelowRel * focus.distance;
  const double margin = kMarginRel * focus.distance;
  std::mt19937 random(1);
  auto pick = [&] { return points[random() % points.size()]; };
  double best_support = 0;
  Plane best;
  for (int trial = 0; trial < kTrials; ++trial) {
    const Eigen::Vector3d a = pick(), b = pick(), c = pick();
    const Eigen::Vector3d n = (b - a).cross(c - a);
    if (n.norm() < 1e-3 * focus.distance * focus.distance) continue;  // too narrow to carry a plane
    Plane plane(n.normalized(), a);
    if (!CamerasAbove(cameras, margin, plane)) continue;
    const double support = Support(points, plane, tolerance, below);
    if (support > best_support) {
      best_support = support;
      best = plane;
    }
  }
  if (best_support < flatness.min_points) return std::nullopt;
  for (int i = 0; i < 3; ++i) best = FitPlane(points, best, tolerance);
  if (!CamerasAbove(cameras, margin, best)) return std::nullopt;
  if (Support(points, best, tolerance, below) < flatness.min_share * static_cast<double>(points.size()))
    return std::nullopt;
  if (best.signedDistance(focus.center) < -0.1 * focus.distance) return std::nullopt;
  if (!Surrounds(points, best, tolerance, focus)) return std::nullopt;
  return GroundPlane{best, Spread(points, best, focus)};
}

}  // namespace

std::optional<GroundPlane> FindGround(const Scene& scene, const std::vector<uint8_t>& use, const Focus& focus) {
  GLINT_CHECK_EQ(use.size(), scene.points.size());
  if (!(focus.distance > 0)) return std::nullopt;
  const std::vector<Eigen::Vector3d> points = ThinnedPoints(scene, use, focus);
  if (points.size() < 3) return std::nullopt;
  std::vector<Eigen::Vector3d> cameras;
  for (const View& view : scene.views) cameras.push_back(view.Center());
  const auto flat = FindPlane(points, cameras, focus, kFlat), rough = FindPlane(points, cameras, focus, kRough);
  const bool same =
      flat && rough && flat->plane.normal().dot(rough->plane.normal()) > std::cos(kSameDeg * M_PI / 180) &&
      rough->plane.absDistance(flat->plane.projection(focus.center)) < kRough.tolerance_rel * focus.distance;
  return flat && !same ? flat : rough;
}

}  // namespace glint
