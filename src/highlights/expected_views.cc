#include "highlights/expected_views.h"

#include <cmath>

#include "core/parallel.h"

namespace glint {
namespace {

constexpr double kMirrorsDeg = 6;   // of a place's normal: it would show the light
constexpr double kClearRel = 0.01;  // how far the seed may be off where it hides things from each other, diagonals

}  // namespace

std::vector<char> ViewsThatShouldShow(const Scene& scene, const SeedSurface& surface, const TriangleMesh& seed,
                                      const std::vector<Eigen::Vector3d>& normals, const Light& light,
                                      double max_incidence_deg) {
  constexpr size_t kMaxPlaces = 3000;
  const double min_cos = std::cos(max_incidence_deg * M_PI / 180), near_cos = std::cos(kMirrorsDeg * M_PI / 180);
  const size_t stride = seed.vertices.size() / kMaxPlaces + 1;
  std::vector<char> shows(scene.views.size(), 0);
  ParallelFor(scene.views.size(), 1, [&](size_t v) {
    const View& view = scene.views[v];
    const Eigen::Vector3d center = view.Center();
    for (size_t i = 0; i < seed.vertices.size() && !shows[v]; i += stride) {
      const Eigen::Vector3d& x = seed.vertices[i];
      const Eigen::Vector3d half = HalfVector(light, view.cam_from_world, x);
      if (half.dot(normals[i]) < near_cos || half.dot((center - x).normalized()) < min_cos) continue;
      const auto px = view.Project(x);
      SurfaceSample at{x, normals[i]};
      at.error_world = kClearRel * surface.diagonal();
      const Eigen::Vector3d lamp = x + 2 * surface.diagonal() * DirectionToLight(light, view.cam_from_world, x);
      shows[v] = px && view.Contains(*px) && !surface.Occluded(at, center) && !surface.Occluded(at, lamp);
    }
  });
  return shows;
}

}  // namespace glint
