#include "refine/lobe.h"

#include <Eigen/Dense>
#include <cmath>

namespace glint {
namespace {

Eigen::Vector3d NormalAt(const TriangleMesh& mesh, const RayHit& hit) {
  const Eigen::Vector3i& f = mesh.faces[hit.face];
  return ((1 - hit.u - hit.v) * mesh.normals[f[0]] + hit.u * mesh.normals[f[1]] + hit.v * mesh.normals[f[2]])
      .normalized();
}

}  // namespace

std::optional<Lobe> LayLobe(const Contact& contact, const Light& light, const TriangleMesh& surface,
                            const RayCaster& caster) {
  Lobe lobe;
  const Eigen::Vector3d half = HalfVector(light, contact.cam_from_world, contact.SurfacePosition());
  lobe.tangents.col(0) = half.unitOrthogonal();
  lobe.tangents.col(1) = half.cross(lobe.tangents.col(0));
  std::array<Eigen::Vector2d, 4> deviation;
  for (int k = 0; k < 4; ++k) {
    const auto hit = caster.Intersect(contact.origin, contact.axis_rays[k]);
    if (!hit) return std::nullopt;
    lobe.position[k] = hit->position;
    lobe.half[k] = HalfVector(light, contact.cam_from_world, hit->position);
    deviation[k] = lobe.tangents.transpose() * (NormalAt(surface, *hit) - lobe.half[k]);
  }
  lobe.turn.col(0) = 0.5 * (deviation[0] - deviation[1]);
  lobe.turn.col(1) = 0.5 * (deviation[2] - deviation[3]);
  return lobe;
}

std::array<Eigen::Vector3d, 4> Lobe::NormalsAtEnds(double width) const {
  const Eigen::JacobiSVD<Eigen::Matrix2d> svd(turn, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Matrix2d round = width * svd.matrixU() * svd.matrixV().transpose();
  std::array<Eigen::Vector3d, 4> normals;
  for (int k = 0; k < 4; ++k) normals[k] = (half[k] + (k % 2 ? -1.0 : 1.0) * tangents * round.col(k / 2)).normalized();
  return normals;
}

}  // namespace glint
