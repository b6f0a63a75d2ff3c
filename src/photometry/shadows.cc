#include "photometry/shadows.h"

#include <cmath>

#include "core/square.h"

namespace glint {
namespace {

constexpr double kLit = 0.15, kTurnedAway = -0.1;  // cosines; between them the surface's error decides
// How far a shadow's edge may be from where the surface throws it, fraction of the diagonal.
constexpr double kErrorRel = 0.02;
constexpr double kMarginRel = 1e-3;
constexpr int kRays = 5;

double Distance(const Light& light, const Rigid3d& cam_from_world, const Eigen::Vector3d& x) {
  return (light.vector - (light.frame == LightFrame::kCamera ? cam_from_world * x : x)).norm();
}

}  // namespace

Shadows::Shadows(const TriangleMesh& surface)
    : caster_(surface), diagonal_(Diagonal(surface)), center_(BoundingBox(surface).center()) {}

std::optional<Eigen::Vector3d> Shadows::Irradiance(const Eigen::Vector3d& x, const Eigen::Vector3d& normal,
                                                   const Light& light, const Rigid3d& cam_from_world) const {
  const Eigen::Vector3d to_light = DirectionToLight(light, cam_from_world, x);
  const double cosine = to_light.dot(normal);
  if (cosine < kTurnedAway) return Eigen::Vector3d::Zero();
  if (cosine < kLit) return std::nullopt;
  const bool near = light.type == LightType::kPoint;
  const double distance = near ? Distance(light, cam_from_world, x) : 4 * diagonal_;
  const int hidden = NumHidden(x, normal, x + distance * to_light);
  if (hidden == kRays) return Eigen::Vector3d::Zero();
  if (hidden > 0) return std::nullopt;
  return near ? Eigen::Vector3d(to_light * Square(Distance(light, cam_from_world, center_) / distance)) : to_light;
}

int Shadows::NumHidden(const Eigen::Vector3d& x, const Eigen::Vector3d& normal, const Eigen::Vector3d& lamp) const {
  const double reach = kErrorRel * diagonal_, margin = kMarginRel * diagonal_;
  const Eigen::Vector3d lifted = x + 0.3 * reach * normal;
  const Eigen::Vector3d u = normal.unitOrthogonal(), v = normal.cross(u);
  int hidden = caster_.Occluded(lifted, lamp, margin);
  for (const Eigen::Vector3d& side : {u, v}) {
    hidden += caster_.Occluded(lifted + reach * side, lamp + reach * side, margin);
    hidden += caster_.Occluded(lifted - reach * side, lamp - reach * side, margin);
  }
  return hidden;
}

}  // namespace glint
