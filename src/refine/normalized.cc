#include "refine/normalized.h"

#include "core/check.h"

namespace glint {

UnitFrame UnitFrame::Of(const TriangleMesh& mesh) {
  const double diagonal = Diagonal(mesh);
  GLINT_CHECK_GT(diagonal, 0);
  return {BoundingBox(mesh).center(), 1 / diagonal};
}

TriangleMesh UnitFrame::FromWorld(TriangleMesh mesh) const {
  for (Eigen::Vector3d& v : mesh.vertices) v = FromWorld(v);
  return mesh;
}

TriangleMesh UnitFrame::ToWorld(TriangleMesh mesh) const {
  for (Eigen::Vector3d& v : mesh.vertices) v = ToWorld(v);
  return mesh;
}

namespace {

// Camera axes keep their directions; lengths are scaled and the centre moves.
Rigid3d WithCenter(Rigid3d cam_from_world, const Eigen::Vector3d& center) {
  cam_from_world.translation = -(cam_from_world.rotation * center);
  return cam_from_world;
}

Contact Scaled(Contact contact, const Eigen::Vector3d& origin, double factor) {
  contact.origin = origin;
  contact.cam_from_world = WithCenter(contact.cam_from_world, origin);
  contact.depth *= factor;
  contact.prior_depth *= factor;
  contact.sigma_depth *= factor;
  return contact;
}

}  // namespace

Contact UnitFrame::FromWorld(const Contact& contact) const { return Scaled(contact, FromWorld(contact.origin), scale); }
Contact UnitFrame::ToWorld(const Contact& contact) const { return Scaled(contact, ToWorld(contact.origin), 1 / scale); }

Light UnitFrame::FromWorld(Light light) const {
  if (light.type != LightType::kPoint) return light;
  light.vector = light.frame == LightFrame::kWorld ? FromWorld(light.vector) : Eigen::Vector3d(scale * light.vector);
  light.sigma *= scale;
  return light;
}

Light UnitFrame::ToWorld(Light light) const {
  if (light.type != LightType::kPoint) return light;
  light.vector = light.frame == LightFrame::kWorld ? ToWorld(light.vector) : Eigen::Vector3d(light.vector / scale);
  light.sigma /= scale;
  return light;
}

}  // namespace glint
