#include "geometry/render_mesh.h"

#include <algorithm>
#include <cmath>

#include "geometry/ray_caster.h"

namespace glint {

namespace {

// Directions spread evenly over the upper half of the unit sphere.
std::vector<Eigen::Vector3d> SkyDirections() {
  constexpr int kCount = 12;
  std::vector<Eigen::Vector3d> directions;
  for (int i = 0; i < kCount; ++i) {
    const double z = std::sqrt((i + 0.5) / kCount), turn = 2.399963229728653 * i, r = std::sqrt(1 - z * z);
    directions.emplace_back(r * std::cos(turn), r * std::sin(turn), z);
  }
  return directions;
}

class MeshTracer {
 public:
  MeshTracer(const TriangleMesh& mesh, const PictureView& view, const MeshLook& look)
      : mesh_(mesh),
        view_(view),
        look_(look),
        caster_(mesh),
        center_(view.CenterInWorld()),
        background_(LinearFromSrgb(look.background)),
        sky_(SkyDirections()),
        reach_(0.25 * Diagonal(mesh)) {}

  Eigen::Vector3d operator()(double x_px, double y_px) const {
    const Eigen::Vector3d direction = view_.DirectionInWorld(x_px, y_px);
    const auto hit = caster_.Intersect(center_, direction);
    if (!hit) return background_;
    const Eigen::Vector3d weights(1 - hit->u - hit->v, hit->u, hit->v);
    const Eigen::Vector3i& face = mesh_.faces[hit->face];
    Seen seen{hit->normal, look_.color};
    if (look_.smooth && !mesh_.normals.empty()) {
      Eigen::Vector3d normal = Eigen::Vector3d::Zero();
      for (int k = 0; k < 3; ++k) normal += weights[k] * mesh_.normals[face[k]];
      if (normal.dot(hit->normal) > 0) seen.normal = normal.normalized();
    }
    if (!mesh_.colors.empty()) {
      for (int c = 0; c < 3; ++c) {
        double value = 0;
        for (int k = 0; k < 3; ++k) value += weights[k] * mesh_.colors[face[k]][c];
        seen.color[c] = static_cast<uint8_t>(std::lround(std::clamp(value, 0.0, 255.0)));
      }
    }
    if (look_.hidden_sky) seen.open = OpenSky(*hit, direction);
    if (look_.edges) {
      const double line = EdgeDistancePx(*hit, face);
      if (line < 0.6) seen.color = {40, 40, 44};
    }
    return Shade(view_, look_, direction, seen);
  }

 private:
  double OpenSky(const RayHit& hit, const Eigen::Vector3d& direction) const {
    const Eigen::Vector3d n = hit.normal.dot(direction) > 0 ? Eigen::Vector3d(-hit.normal) : hit.normal;
    const Eigen::Vector3d u = n.unitOrthogonal(), v = n.cross(u);
    int open = 0;
    for (const Eigen::Vector3d& s : sky_) {
      const Eigen::Vector3d to = s[0] * u + s[1] * v + s[2] * n;
      open += !caster_.Intersect(hit.position, to, 1e-4 * reach_, reach_).has_value();
    }
    return static_cast<double>(open) / static_cast<double>(sky_.size());
  }

  double EdgeDistancePx(const RayHit& hit, const Eigen::Vector3i& face) const {
    double nearest = 1e300;
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d &a = mesh_.vertices[face[k]], &b = mesh_.vertices[face[(k + 1) % 3]];
      nearest = std::min(nearest, (hit.position - a).cross(b - a).norm() / (b - a).norm());
    }
    return nearest * view_.focal_px / hit.t;
  }

  const TriangleMesh& mesh_;
  const PictureView& view_;
  const MeshLook& look_;
  RayCaster caster_;
  Eigen::Vector3d center_, background_;
  std::vector<Eigen::Vector3d> sky_;
  double reach_;
};

}  // namespace

std::vector<uint8_t> RenderMesh(const TriangleMesh& mesh, const PictureView& view, const MeshLook& look) {
  const MeshTracer tracer(mesh, view, look);
  return RenderPixels(view, look, [&](double x, double y) { return tracer(x, y); });
}

}  // namespace glint
