// Exact highlights on an ellipsoid: for every view and light the surface point whose normal is the half vector.
#pragma once

#include <cmath>
#include <random>
#include <vector>

#include "constraints/contact.h"
#include "light/light.h"
#include "refine/bundle.h"

namespace glint::testing {

struct Ellipsoid {
  Eigen::Vector3d radii = {1.0, 0.8, 0.6};

  Eigen::Vector3d PointWithNormal(const Eigen::Vector3d& n) const {
    const Eigen::Vector3d squared = radii.cwiseAbs2();
    return squared.cwiseProduct(n) / std::sqrt(n.dot(squared.cwiseProduct(n)));
  }
  double Diagonal() const { return 2 * radii.norm(); }
};

inline Rigid3d LookAtOrigin(const Eigen::Vector3d& center) {
  const Eigen::Vector3d z = -center.normalized();
  const Eigen::Vector3d x = z.cross(Eigen::Vector3d(0.1, 0.2, -1)).normalized();
  Eigen::Matrix3d rotation;
  rotation << x.transpose(), z.cross(x).transpose(), z.transpose();
  Rigid3d cam_from_world;
  cam_from_world.rotation = Eigen::Quaterniond(rotation).normalized();
  cam_from_world.translation = -(cam_from_world.rotation * center);
  return cam_from_world;
}

// Views on a dome of radius 4.
inline std::vector<Rigid3d> DomeViews(int count) {
  std::vector<Rigid3d> views;
  for (int i = 0; i < count; ++i) {
    const double azimuth = 2.399963 * i, z = 0.05 + 0.85 * (i + 0.5) / count;
    const double r = std::sqrt(1 - z * z);
    views.push_back(LookAtOrigin(4 * Eigen::Vector3d(r * std::cos(azimuth), r * std::sin(azimuth), z)));
  }
  return views;
}

struct EllipsoidContacts {
  std::vector<Contact> contacts;     // with true depths
  std::vector<SurfacePoint> points;  // exact, with true normals
};

inline EllipsoidContacts MakeEllipsoidContacts(const Ellipsoid& shape, const std::vector<Light>& lights, int num_views,
                                               int num_points) {
  EllipsoidContacts scene;
  const std::vector<Rigid3d> views = DomeViews(num_views);
  for (size_t v = 0; v < views.size(); ++v)
    for (size_t l = 0; l < lights.size(); ++l) {
      Eigen::Vector3d n = Eigen::Vector3d::UnitZ();
      Eigen::Vector3d x = shape.PointWithNormal(n);
      for (int k = 0; k < 100; ++k) {
        n = HalfVector(lights[l], views[v], x);
        x = shape.PointWithNormal(n);
      }
      Contact c;
      c.highlight = static_cast<uint32_t>(scene.contacts.size());
      c.view = static_cast<uint32_t>(v);
      c.light = static_cast<int>(l);
      c.cam_from_world = views[v];
      c.origin = views[v].Inverse().translation;
      c.depth = (x - c.origin).norm();
      c.direction = (x - c.origin) / c.depth;
      c.prior_depth = c.depth;
      c.sigma_normal = 0.5 * M_PI / 180;
      if (Incidence(c, lights[l]) < 60 * M_PI / 180) scene.contacts.push_back(c);
    }
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  for (int i = 0; i < num_points; ++i) {
    const Eigen::Vector3d n = Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized();
    scene.points.push_back({shape.PointWithNormal(n), n, 0.002, shape.PointWithNormal(n)});
  }
  return scene;
}

inline Light DistantLight(double x, double y, double z) {
  Light light;
  light.vector = Eigen::Vector3d(x, y, z).normalized();
  return light;
}

}  // namespace glint::testing
