#include "colmap/scene.h"

#include <algorithm>
#include <numeric>
#include <unordered_map>

#include "core/check.h"

namespace glint {

Eigen::Vector3d View::Center() const { return cam_from_world.Inverse().translation; }

std::optional<Eigen::Vector3d> View::RayThrough(const Eigen::Vector2d& px) const {
  const auto bearing = BearingOfPixel(camera, px);
  if (!bearing) return std::nullopt;
  return cam_from_world.rotation.conjugate() * *bearing;
}

std::optional<Eigen::Vector2d> View::Project(const Eigen::Vector3d& x_in_world) const {
  return ProjectToPixel(camera, cam_from_world * x_in_world);
}

bool View::Contains(const Eigen::Vector2d& px) const {
  return px.x() >= 0 && px.y() >= 0 && px.x() <= static_cast<double>(camera.width) &&
         px.y() <= static_cast<double>(camera.height);
}

Scene MakeScene(const Model& model) {
  std::vector<const Image*> images;
  for (const Image& image : model.images) images.push_back(&image);
  std::sort(images.begin(), images.end(), [](const Image* a, const Image* b) { return a->name < b->name; });

  Scene scene;
  scene.views.reserve(images.size());
  std::unordered_map<uint32_t, uint32_t> view_of_image;
  std::vector<bool> pixels_known;
  for (const Image* image : images) {
    view_of_image.emplace(image->id, static_cast<uint32_t>(scene.views.size()));
    const auto camera = model.cameras.find(image->camera_id);
    GLINT_CHECK(camera != model.cameras.end());
    scene.views.push_back({image->name, image->id, camera->second, image->cam_from_world});
    pixels_known.push_back(!HasZeroedPoints(*image));
  }
  scene.points.reserve(model.points.size());
  for (const Point3D& point : model.points) {
    ScenePoint& out = scene.points.emplace_back(ScenePoint{point.xyz, point.rgb, point.error_px, {}});
    out.observations.reserve(point.track.size());
    for (const TrackElement& element : point.track) {
      const auto view = view_of_image.find(element.image_id);
      GLINT_CHECK(view != view_of_image.end());
      GLINT_CHECK_LT(element.point2d_index, images[view->second]->points2d.size());
      Eigen::Vector2d px = images[view->second]->points2d[element.point2d_index].px;
      if (!pixels_known[view->second]) {
        const auto projected = scene.views[view->second].Project(point.xyz);
        if (!projected || !scene.views[view->second].Contains(*projected)) continue;
        px = *projected;
      }
      out.observations.push_back({view->second, px.cast<float>()});
    }
  }
  return scene;
}

Eigen::Vector3d TowardViews(const Scene& scene, const ScenePoint& point) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Observation& o : point.observations) sum += (scene.views[o.view].Center() - point.position).normalized();
  return sum;
}

}  // namespace glint
