// Points on analytic surfaces seen by simulated cameras.
#pragma once

#include <functional>
#include <random>

#include "colmap/scene.h"

namespace glint {

// Cameras on a dome of `radius` around the origin, 20 to 60 degrees above the horizon.
inline Scene DomeScene(int num_views, double radius) {
  Scene scene;
  for (int i = 0; i < num_views; ++i) {
    const double azimuth = 2 * M_PI * i / num_views * 3, elevation = (20 + 40.0 * i / num_views) * M_PI / 180;
    const Eigen::Vector3d center =
        radius * Eigen::Vector3d(std::cos(azimuth) * std::cos(elevation), std::sin(azimuth) * std::cos(elevation),
                                 std::sin(elevation));
    View view;
    view.name = "view_" + std::to_string(i);
    view.image_id = static_cast<uint32_t>(i + 1);
    view.camera = {1, CameraModel::kPinhole, 800, 600, {900, 900, 400, 300}};
    const Eigen::Vector3d z = -center.normalized(), x = z.cross(Eigen::Vector3d::UnitZ()).normalized();
    Eigen::Matrix3d cam_from_world;
    cam_from_world << x.transpose(), z.cross(x).transpose(), z.transpose();
    view.cam_from_world.rotation = Eigen::Quaterniond(cam_from_world).normalized();
    view.cam_from_world.translation = -(view.cam_from_world.rotation * center);
    scene.views.push_back(view);
  }
  return scene;
}

// Adds a point with an observation in every view that `sees` it; noise moves the point across about one pixel.
inline void AddPoint(Scene& scene, const Eigen::Vector3d& x,
                     const std::function<bool(const Eigen::Vector3d& eye)>& sees, size_t min_views = 3) {
  ScenePoint point{x, {128, 128, 128}, 0.5, {}};
  for (size_t v = 0; v < scene.views.size(); ++v) {
    const auto px = scene.views[v].Project(x);
    if (px && scene.views[v].Contains(*px) && sees(scene.views[v].Center()))
      point.observations.push_back({static_cast<uint32_t>(v), px->cast<float>()});
  }
  if (point.observations.size() >= min_views) scene.points.push_back(point);
}

// `count` points spread evenly on the unit sphere, those that at least three views see.
inline void AddSphere(Scene& scene, int count) {
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (2 * i + 1.0) / count, azimuth = i * 2.399963229728653;
    const Eigen::Vector3d n(std::sqrt(1 - z * z) * std::cos(azimuth), std::sqrt(1 - z * z) * std::sin(azimuth), z);
    AddPoint(scene, n, [&](const Eigen::Vector3d& eye) { return n.dot(eye - n) > 0.15 * (eye - n).norm(); });
  }
}

// Texture on the plane z = `height`, hidden by the unit sphere where it is.
inline void AddGround(Scene& scene, double height, double half_size, int per_side) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> jitter(-0.3, 0.3);
  for (int i = 0; i < per_side; ++i)
    for (int j = 0; j < per_side; ++j) {
      const double step = 2 * half_size / per_side;
      const Eigen::Vector3d x(-half_size + step * (i + 0.5 + jitter(random)),
                              -half_size + step * (j + 0.5 + jitter(random)), height);
      AddPoint(scene, x, [&](const Eigen::Vector3d& eye) {
        const Eigen::Vector3d d = (eye - x).normalized();
        return x.cross(d).norm() > 1 || x.dot(d) > 0;
      });
    }
}

}  // namespace glint
