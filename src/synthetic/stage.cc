#include "synthetic/stage.h"

#include <algorithm>
#include <cmath>

namespace glint {
namespace {

using Eigen::Vector3d;

constexpr double kShadowOffset = 2e-3;  // along the normal, so that a surface does not shadow itself
constexpr double kFarAway = 60;         // the ground ends there

}  // namespace

double StageLight::Distance(const Rigid3d& cam_from_stage, const Vector3d& x) const {
  if (light.type == LightType::kDistant) return 1e6;
  if (light.frame == LightFrame::kWorld) return (light.vector - x).norm();
  return (light.vector - cam_from_stage * x).norm();
}

Vector3d StageView::Center() const { return cam_from_stage.Inverse().translation; }

std::optional<Vector3d> StageView::RayThrough(const Eigen::Vector2d& px) const {
  const auto bearing = BearingOfPixel(camera, px);
  if (!bearing) return std::nullopt;
  return Vector3d(cam_from_stage.rotation.conjugate() * *bearing);
}

std::optional<Eigen::Vector2d> StageView::Project(const Vector3d& x) const {
  return ProjectToPixel(camera, cam_from_stage * x);
}

bool StageView::Contains(const Eigen::Vector2d& px) const {
  return px.x() >= 0 && px.y() >= 0 && px.x() < static_cast<double>(camera.width) &&
         px.y() < static_cast<double>(camera.height);
}

bool Stage::OpaqueAt(const Vector3d& x) const {
  if (!transparent()) return true;
  const double u = x.x() / kPaneHalfLength, v = x.y() / kPaneHalfWidth;
  const double border = 0.87;
  return u * u * u * u + v * v * v * v > border * border * border * border || marks.At(x);
}

SurfaceHit Stage::Trace(const Vector3d& origin, const Vector3d& direction, bool past_object) const {
  SurfaceHit hit;
  hit.t = kFarAway;
  if (direction.z() < 0) {
    const double t = (surroundings.ground_z() - origin.z()) / direction.z();
    if (t > 0 && t < hit.t) hit = {SurfaceKind::kGround, t, origin + t * direction, Vector3d::UnitZ()};
  }
  if (const ImplicitShape* interior = surroundings.interior())
    if (const auto inside = TraceRay(*interior, origin, direction, 0, hit.t))
      hit = {SurfaceKind::kInterior, inside->t, inside->position, inside->normal};
  if (!past_object)
    if (const auto object = TraceRay(*shape, origin, direction, 0, hit.t))
      hit = {SurfaceKind::kObject, object->t, object->position, object->normal};
  return hit;
}

double Stage::Visibility(const SurfaceHit& from, const Vector3d& direction, double distance) const {
  const Vector3d origin = from.position + kShadowOffset * from.normal;
  const ImplicitShape* interior = surroundings.interior();
  if (interior && RayMeets(*interior, origin, direction, 0, distance)) return 0;
  if (from.kind == SurfaceKind::kObject && transparent()) return 1;
  if (!RayMeets(*shape, origin, direction, 0, distance)) return 1;
  return gloss.transmittance.mean();
}

}  // namespace glint
