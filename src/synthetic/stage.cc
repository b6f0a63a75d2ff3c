#include "synthetic/stage.h"

#include <algorithm>
#include <cmath>

namespace glint {
namespace {

using Eigen::Vector3d;

constexpr double kShadowOffset = 2e-3;  // along the normal, so that a surface does not shadow itself
constexpr double kSamePoint = 5e-3;     // a ray that ends that near to a point has reached it
constexpr double kMetallic = 0.2;       // reflectance at normal incidence from which a surface is metal
constexpr double kPaintReflectance = 0.04;
constexpr double kFarAway = 60;  // the ground ends there

}  // namespace

double StageLight::Distance(const Rigid3d& cam_from_stage, const Vector3d& x) const {
  if (light.type == LightType::kDistant) return 1e6;
  if (light.frame == LightFrame::kWorld) return (light.vector - x).norm();
  return (light.vector - cam_from_stage * x).norm();
}

Vector3d StageView::Center() const { return cam_from_stage.Inverse().translation; }

std::optional<Vector3d> StageView::RayThrough(const Eigen::Vector2d& px) const {
  if (camera.model == CameraModel::kPinhole) {  // straight, for speed
    const std::vector<double>& p = camera.params;
    return cam_from_stage.rotation.conjugate() *
           Vector3d((px.x() - p[2]) / p[0], (px.y() - p[3]) / p[1], 1).normalized();
  }
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

Eigen::Array3d Stage::ReflectanceAt(const Vector3d& x) const {
  if (gloss.reflectance.mean() < kMetallic || !marks.At(x)) return gloss.reflectance;
  return Eigen::Array3d::Constant(kPaintReflectance);
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
  if (const ShapeTracer* interior = surroundings.interior())
    if (const auto inside = interior->Trace(origin, direction, 0, hit.t))
      hit = {SurfaceKind::kInterior, inside->t, inside->position, inside->normal};
  if (!past_object)
    if (const auto object = tracer->Trace(origin, direction, 0, hit.t))
      hit = {SurfaceKind::kObject, object->t, object->position, object->normal};
  return hit;
}

std::optional<Eigen::Vector2d> Stage::SeenAt(const StageView& view, const SurfaceHit& point) const {
  auto px = view.Project(point.position);
  if (!px || !view.Contains(*px)) return std::nullopt;
  const Vector3d center = view.Center(), direction = (point.position - center).normalized();
  if (direction.dot(point.normal) >= 0) return std::nullopt;
  SurfaceHit hit = Trace(center, direction);
  if (point.kind != SurfaceKind::kObject && hit.kind == SurfaceKind::kObject && !OpaqueAt(hit.position))
    hit = Trace(center, direction, true);
  if (hit.kind != point.kind || (hit.position - point.position).norm() > kSamePoint) return std::nullopt;
  return px;
}

double Stage::Visibility(const SurfaceHit& from, const Vector3d& direction, double distance) const {
  const Vector3d origin = from.position + kShadowOffset * from.normal;
  const ShapeTracer* interior = surroundings.interior();
  if (interior && interior->Meets(origin, direction, 0, distance)) return 0;
  if (from.kind == SurfaceKind::kObject && transparent()) return 1;
  if (!tracer->Meets(origin, direction, 0, distance)) return 1;
  return gloss.transmittance.mean();
}

}  // namespace glint
