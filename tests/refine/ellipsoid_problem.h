// An ellipsoid with exact highlights and noisy points, to be refined from a dented seed.
#pragma once

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

#include "core/square.h"
#include "refine/refine.h"
#include "tests/support/ellipsoid_scene.h"
#include "tests/support/shapes.h"

namespace glint::testing {

struct Problem {
  Ellipsoid shape;
  Scene scene;
  TriangleMesh seed;
  std::vector<uint8_t> point_used;
  std::vector<Highlight> highlights;
  std::vector<Light> lights;
  std::vector<Eigen::Vector3d> contact_positions;  // true

  RefineInput Input() const { return {scene, seed, point_used, highlights, lights}; }
};

// Where the ray through a pixel first meets the unit-scale ellipsoid.
inline Eigen::Vector3d Hit(const Ellipsoid& shape, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
  const Eigen::Vector3d o = origin.cwiseQuotient(shape.radii), d = direction.cwiseQuotient(shape.radii);
  const double a = d.squaredNorm(), b = o.dot(d), c = o.squaredNorm() - 1;
  return origin + (-b - std::sqrt(std::max(0.0, b * b - a * c))) / a * direction;
}

// The blob of a lobe of 1.5 degrees: where normal and half vector are that far apart.
inline Eigen::Matrix2d BlobMoments(const Ellipsoid& shape, const View& unit_view, const Light& light,
                                   const Eigen::Vector2d& px) {
  const auto turn = [&](const Eigen::Vector2d& at) -> Eigen::Vector3d {
    const Eigen::Vector3d x = Hit(shape, unit_view.Center(), *unit_view.RayThrough(at));
    const Eigen::Vector3d normal = x.cwiseQuotient(shape.radii.cwiseAbs2()).normalized();
    return normal - HalfVector(light, unit_view.cam_from_world, x);
  };
  Eigen::Matrix<double, 3, 2> jacobian;
  for (int k = 0; k < 2; ++k)
    jacobian.col(k) = (turn(px + Eigen::Vector2d::Unit(k)) - turn(px - Eigen::Vector2d::Unit(k))) / 2;
  return Square(1.5 * M_PI / 180) * (jacobian.transpose() * jacobian).inverse();
}

// A seed that is dented and faceted by a few percent, exact highlights, sparse points with a little noise.
inline Problem MakeProblem(double scale = 1, const Eigen::Vector3d& offset = Eigen::Vector3d::Zero()) {
  Problem p;
  p.lights = {DistantLight(1, 0.2, 1), DistantLight(-0.8, 0.5, 1)};
  const EllipsoidContacts truth = MakeEllipsoidContacts(p.shape, p.lights, 48, 200);
  Camera camera;
  camera.model = CameraModel::kPinhole;
  camera.width = 800;
  camera.height = 600;
  camera.params = {900, 900, 400, 300};
  for (const Rigid3d& cam_from_unit : DomeViews(48)) {
    View view;
    view.camera = camera;
    view.cam_from_world.rotation = cam_from_unit.rotation;
    const Eigen::Vector3d center = scale * cam_from_unit.Inverse().translation + offset;
    view.cam_from_world.translation = -(view.cam_from_world.rotation * center);
    p.scene.views.push_back(view);
  }
  for (const Contact& c : truth.contacts) {
    const Eigen::Vector3d x = scale * c.Position() + offset;
    Highlight h;
    h.view = c.view;
    h.light = c.light;
    h.px = *p.scene.views[c.view].Project(x);
    h.covariance_px = 0.01 * Eigen::Matrix2d::Identity();
    View unit_view = p.scene.views[c.view];
    unit_view.cam_from_world = c.cam_from_world;
    h.moments_px = BlobMoments(p.shape, unit_view, p.lights[c.light], h.px);
    p.highlights.push_back(h);
    p.contact_positions.push_back(x);
  }
  for (const SurfacePoint& s : truth.points) {
    ScenePoint point{scale * s.position + offset, {200, 200, 200}, 0.5, {}};
    for (uint32_t v = 0; v < 3; ++v)
      point.observations.push_back({v, p.scene.views[v].Project(point.position)->cast<float>()});
    p.scene.points.push_back(point);
  }
  p.point_used.assign(p.scene.points.size(), 1);
  p.seed = Icosphere(3);
  for (Eigen::Vector3d& v : p.seed.vertices) {
    const double dent = 0.96 + 0.03 * std::sin(5 * v.x() + 1) * std::cos(4 * v.y()) + 0.01 * std::sin(40 * v.z());
    v = scale * dent * p.shape.radii.cwiseProduct(v) + offset;
  }
  return p;
}

}  // namespace glint::testing
