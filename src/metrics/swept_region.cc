#include "metrics/swept_region.h"

#include <cmath>

#include "core/check.h"
#include "core/parallel.h"
#include "geometry/ray_caster.h"

namespace glint {
namespace {

constexpr size_t kGrain = 128;
constexpr double kMarginRel = 1e-4;  // of the diagonal: what starts on the surface must not hit its own faces

TriangleMesh Joined(const TriangleMesh& a, const TriangleMesh* b) {
  TriangleMesh out;
  out.vertices = a.vertices;
  out.faces = a.faces;
  if (b == nullptr) return out;
  const Eigen::Vector3i offset = Eigen::Vector3i::Constant(static_cast<int>(a.vertices.size()));
  out.vertices.insert(out.vertices.end(), b->vertices.begin(), b->vertices.end());
  for (const Eigen::Vector3i& f : b->faces) out.faces.push_back(f + offset);
  return out;
}

// Whether a vertex is seen by a view, and lit by a light.
class Sight {
 public:
  Sight(const TriangleMesh& truth, const TriangleMesh* occluders)
      : truth_(truth), caster_(Joined(truth, occluders)), margin_(kMarginRel * Diagonal(truth)) {
    GLINT_CHECK_EQ(truth.normals.size(), truth.vertices.size());
  }

  bool Seen(size_t vertex, const View& view, const Eigen::Vector3d& center) const {
    const Eigen::Vector3d& x = truth_.vertices[vertex];
    if (truth_.normals[vertex].dot(center - x) <= 0) return false;
    const std::optional<Eigen::Vector2d> px = view.Project(x);
    return px && view.Contains(*px) && !caster_.Occluded(x, center, margin_);
  }

  bool Lit(size_t vertex, const Light& light, const View& view) const {
    const Eigen::Vector3d& x = truth_.vertices[vertex];
    const Eigen::Vector3d l = DirectionToLight(light, view.cam_from_world, x);
    if (truth_.normals[vertex].dot(l) <= 0) return false;
    if (light.type == LightType::kDistant) return !caster_.Intersect(x, l, margin_).has_value();
    const Eigen::Vector3d position = light.frame == LightFrame::kWorld
                                         ? light.vector
                                         : Eigen::Vector3d(view.cam_from_world.Inverse() * light.vector);
    return !caster_.Occluded(x, position, margin_);
  }

 private:
  const TriangleMesh& truth_;
  RayCaster caster_;
  double margin_;
};

std::vector<Eigen::Vector3d> Centers(const Scene& scene) {
  std::vector<Eigen::Vector3d> centers;
  for (const View& view : scene.views) centers.push_back(view.Center());
  return centers;
}

}  // namespace

std::vector<uint8_t> SweptRegion(const TriangleMesh& truth, const Scene& scene, const std::vector<Light>& lights,
                                 double max_angle_deg, const TriangleMesh* occluders) {
  const Sight sight(truth, occluders);
  const std::vector<Eigen::Vector3d> centers = Centers(scene);
  const double min_cos = std::cos(max_angle_deg * M_PI / 180);
  std::vector<uint8_t> swept(truth.vertices.size(), 0);
  auto is_swept = [&](size_t i) {
    for (const Light& light : lights)
      for (size_t v = 0; v < scene.views.size(); ++v) {
        const View& view = scene.views[v];
        if (HalfVector(light, view.cam_from_world, truth.vertices[i]).dot(truth.normals[i]) < min_cos) continue;
        if (sight.Seen(i, view, centers[v]) && sight.Lit(i, light, view)) return true;
      }
    return false;
  };
  ParallelFor(swept.size(), kGrain, [&](size_t i) { swept[i] = is_swept(i) ? 1 : 0; });
  return swept;
}

std::vector<uint16_t> VisibleViews(const TriangleMesh& truth, const Scene& scene, const TriangleMesh* occluders) {
  const Sight sight(truth, occluders);
  const std::vector<Eigen::Vector3d> centers = Centers(scene);
  std::vector<uint16_t> count(truth.vertices.size(), 0);
  ParallelFor(count.size(), kGrain, [&](size_t i) {
    for (size_t v = 0; v < scene.views.size(); ++v)
      if (sight.Seen(i, scene.views[v], centers[v])) ++count[i];
  });
  return count;
}

}  // namespace glint
