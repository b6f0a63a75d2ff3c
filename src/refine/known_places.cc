#include "refine/known_places.h"

#include <algorithm>
#include <cmath>

#include "constraints/point_covariance.h"
#include "core/check.h"

namespace glint {

KnownPlaces::KnownPlaces(const RefineInput& input, const RefineOptions& options, const UnitFrame& frame,
                         Progress& progress)
    : min_sigma_(options.min_point_sigma_rel),
      rim_(KnownOutlinePlaces(input.scene, input.outline, frame)),
      photo_(input.scene, input.images, options.photo, frame, progress) {
  const Scene& scene = input.scene;
  if (options.use_outlines) outline_ = RaysOf(scene, input.outline, frame);
  if (input.point_used.empty()) return;
  GLINT_CHECK_EQ(input.point_used.size(), scene.points.size());
  const std::vector<Eigen::Matrix3d> covariances = PointCovariances(scene, input.point_used);
  for (size_t i = 0; i < scene.points.size(); ++i) {
    if (!input.point_used[i]) continue;
    points_.emplace_back().position = frame.FromWorld(scene.points[i].position);
    covariance_.push_back(frame.scale * frame.scale * covariances[i]);
  }
  num_sparse_ = points_.size();
}

void KnownPlaces::LookForTexture(const TriangleMesh& surface, const std::vector<Light>& lights) {
  points_.resize(num_sparse_);
  covariance_.resize(num_sparse_);
  for (const PhotoPoint& p : photo_.Look(surface, lights)) {
    points_.emplace_back().position = p.position;
    covariance_.push_back(p.sigma * p.sigma * Eigen::Matrix3d::Identity());
  }
}

void KnownPlaces::Update(const LevelSet& field) {
  for (size_t i = 0; i < points_.size(); ++i) {
    SurfacePoint& p = points_[i];
    const Eigen::Vector3d g = field.Gradient(p.position);
    // Off the band there is no normal; a zero one ties the point to no contact.
    p.normal = g.norm() > 0.5 ? Eigen::Vector3d(g.normalized()) : Eigen::Vector3d::Zero();
    p.surface_position = p.position - field.Value(p.position) * p.normal;
    // Across the surface; off the band, where that is unknown, an average direction's.
    const Eigen::Matrix3d& c = covariance_[i];
    const double variance = p.normal.isZero() ? c.trace() / 3 : p.normal.dot(c * p.normal);
    p.sigma = std::max(min_sigma_, std::sqrt(variance));
  }
}

std::vector<SurfacePoint> KnownPlaces::Anchors(const LevelSet& field) const {
  std::vector<SurfacePoint> places = points_;
  for (SurfacePoint p : rim_) {
    const Eigen::Vector3d g = field.Gradient(p.position);
    if (g.norm() < 0.5) continue;  // off the band: the surface is elsewhere
    p.surface_position = p.position - field.Value(p.position) * g.normalized();
    places.push_back(p);
  }
  return places;
}

}  // namespace glint
