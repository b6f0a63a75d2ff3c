// What the stages need of a COLMAP model: views and points, densely indexed.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "colmap/camera.h"
#include "colmap/model.h"
#include "geometry/rigid.h"

namespace glint {

struct View {
  std::string name;       // COLMAP's image name
  uint32_t image_id = 0;  // COLMAP's image id
  Camera camera;
  Rigid3d cam_from_world;

  Eigen::Vector3d Center() const;  // camera centre in the world
  // Unit viewing direction in the world through a pixel (COLMAP's frame), from the centre into the scene.
  std::optional<Eigen::Vector3d> RayThrough(const Eigen::Vector2d& px) const;
  // Pixel of a world point; nullopt where the camera model cannot see it. May lie outside the image.
  std::optional<Eigen::Vector2d> Project(const Eigen::Vector3d& x_in_world) const;
  bool Contains(const Eigen::Vector2d& px) const;
};

struct Observation {
  uint32_t view;  // index into Scene::views
  Eigen::Vector2f px;
};

struct ScenePoint {
  Eigen::Vector3d position;
  std::array<uint8_t, 3> rgb;
  double error_px;
  std::vector<Observation> observations;
};

struct Scene {
  std::vector<View> views;
  std::vector<ScenePoint> points;
};

// Sum of the unit directions to the views that observe the point: the side that it is seen from.
Eigen::Vector3d TowardViews(const Scene& scene, const ScenePoint& point);

// Views sorted by name. Where an image's pixels were dropped (HasZeroedPoints) an observation is the projection of its
// point, left out if that is outside the image.
Scene MakeScene(const Model& model);

}  // namespace glint
