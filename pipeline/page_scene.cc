#include <algorithm>
#include <cmath>

#include "pipeline/page_parts.h"

namespace glint {
namespace {

// Six digits are finer than a screen, and do not depend on the last bit of a sum.
double Rounded(double x) { return std::round(x * 1e6) / 1e6; }

Json ToJson(const Eigen::Vector3d& x) { return {Rounded(x.x()), Rounded(x.y()), Rounded(x.z())}; }

// The ray through a corner of the image, or the outermost one towards it that the lens can see.
Eigen::Vector3d CornerRay(const View& view, double x, double y) {
  const Eigen::Vector2d size(static_cast<double>(view.camera.width), static_cast<double>(view.camera.height));
  for (int step = 20; step > 0; --step) {
    const Eigen::Vector2d from_middle = 0.5 * size.cwiseProduct(Eigen::Vector2d(x, y)) * (step / 20.0);
    if (const auto ray = view.RayThrough(0.5 * size + from_middle)) return *ray;
  }
  return view.cam_from_world.rotation.conjugate() * Eigen::Vector3d::UnitZ();
}

size_t MostAccepted(const Scene& scene, const std::vector<Highlight>& highlights) {
  std::vector<size_t> accepted(scene.views.size(), 0);
  for (const Highlight& h : highlights) accepted[h.view] += h.status == HighlightStatus::kAccepted;
  return static_cast<size_t>(std::max_element(accepted.begin(), accepted.end()) - accepted.begin());
}

}  // namespace

Json PageViews(const Scene& scene, const std::vector<Highlight>& highlights, const PageFrame& frame) {
  Json views = Json::array();
  Eigen::Vector3d up = Eigen::Vector3d::Zero();
  for (const View& view : scene.views) {
    up -= view.cam_from_world.rotation.conjugate() * Eigen::Vector3d::UnitY();
    Json corners = Json::array();
    for (const auto& [x, y] : {std::pair(-1, -1), std::pair(1, -1), std::pair(1, 1), std::pair(-1, 1)})
      corners.push_back(ToJson(CornerRay(view, x, y)));
    views.push_back(
        {{"name", view.name}, {"center", ToJson(frame.FromWorld(view.Center()))}, {"corners", std::move(corners)}});
  }
  // Cameras that look straight down, or in all ways, agree on no upward direction.
  if (!(up.norm() > 0.05 * static_cast<double>(scene.views.size()))) up = Eigen::Vector3d::UnitZ();
  return {{"views", std::move(views)},
          {"up", ToJson(up.normalized())},
          {"start", scene.views.empty() ? 0 : MostAccepted(scene, highlights)}};
}

Json PageContacts(const std::vector<Contact>& contacts, const std::vector<Light>& lights, const PageFrame& frame) {
  Json json = Json::array();
  for (const Contact& contact : contacts) {
    const auto light = static_cast<size_t>(contact.light);
    if (contact.light < 0 || light >= lights.size()) continue;
    json.push_back({{"view", contact.view},
                    {"light", contact.light},
                    {"at", ToJson(frame.FromWorld(contact.Position()))},
                    {"normal", ToJson(ContactNormal(contact, lights[light]))},
                    {"sigma_depth_rel", Rounded(contact.sigma_depth / frame.diagonal)}});
  }
  return json;
}

Json PageLights(const std::vector<FoundLight>& lights, const Scene& scene, const PageFrame& frame) {
  Json json = Json::array();
  for (const FoundLight& found : lights) {
    const Light& light = found.light;
    const bool distant = light.type == LightType::kDistant, world = light.frame == LightFrame::kWorld;
    const auto in_page = [&](const Eigen::Vector3d& in_world) {
      return ToJson(distant ? in_world : frame.FromWorld(in_world));
    };
    Json vectors = Json::array();
    if (world) {
      vectors.push_back(in_page(light.vector));
    } else {
      for (const View& view : scene.views) {
        const Rigid3d world_from_cam = view.cam_from_world.Inverse();
        vectors.push_back(in_page(distant ? world_from_cam.rotation * light.vector : world_from_cam * light.vector));
      }
    }
    json.push_back({{"distant", distant},
                    {"world", world},
                    {"vectors", std::move(vectors)},
                    {"sigma", Rounded(distant ? light.sigma : light.sigma / frame.diagonal)},
                    {"determined", found.determined}});
  }
  return json;
}

}  // namespace glint
