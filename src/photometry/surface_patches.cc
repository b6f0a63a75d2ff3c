#include "photometry/surface_patches.h"

#include <algorithm>
#include <cmath>
#include <unordered_set>

#include "core/check.h"
#include "core/parallel.h"
#include "highlights/surface_views.h"

namespace glint {
namespace {

constexpr double kRadians = M_PI / 180;
// Flatter than this a view says little, and the gloss takes much of the light.
const double kMinCosine = std::cos(60 * kRadians);
constexpr size_t kMaxViews = 24;
constexpr size_t kMaxLooks = 12;  // taken of these
// Half vector to normal: further away a lobe of common gloss has faded, even where the normal is that of a seed.
const double kMirrorCosine = std::cos(20 * kRadians);

// The first vertex in each cell of the grid.
std::vector<size_t> OneACell(const std::vector<Eigen::Vector3d>& vertices, double spacing) {
  std::unordered_set<uint64_t> taken;
  std::vector<size_t> chosen;
  for (size_t v = 0; v < vertices.size(); ++v) {
    uint64_t cell = 0;
    for (int axis = 0; axis < 3; ++axis)
      cell = cell << 21 |
             (static_cast<uint64_t>(static_cast<int64_t>(std::floor(vertices[v][axis] / spacing))) & 0x1fffff);
    if (taken.insert(cell).second) chosen.push_back(v);
  }
  return chosen;
}

}  // namespace

std::vector<SurfacePatch> SpreadPatches(const TriangleMesh& surface, const Scene& scene, double spacing_world) {
  GLINT_CHECK_EQ(surface.normals.size(), surface.vertices.size());
  const SurfaceViews views(surface, scene);
  const std::vector<size_t> chosen = OneACell(surface.vertices, spacing_world);
  std::vector<SurfacePatch> patches(chosen.size());
  ParallelFor(chosen.size(), 64, [&](size_t i) {
    SurfacePatch& patch = patches[i];
    patch.position = surface.vertices[chosen[i]];
    patch.normal = surface.normals[chosen[i]].normalized();
    patch.radius_world = 0.5 * spacing_world;
    for (const SeenBy& seen : views.Squarest(patch.position, patch.normal, kMinCosine, kMaxViews)) {
      const View& view = scene.views[seen.view];
      const double depth = std::max((view.cam_from_world * patch.position).z(), 1e-12);
      patch.views.push_back(
          {seen.view, seen.px, static_cast<float>(patch.radius_world * MeanFocalLength(view.camera) / depth)});
    }
  });
  return patches;
}

bool Mirrors(const View& view, const std::vector<Light>& lights, const SurfacePatch& patch) {
  return std::any_of(lights.begin(), lights.end(), [&](const Light& light) {
    return ShinesIn(light, view.name) &&
           HalfVector(light, view.cam_from_world, patch.position).dot(patch.normal) > kMirrorCosine;
  });
}

void TakeLooks(const Scene& scene, const ViewColors& colors, const std::vector<Light>& lights,
               std::vector<SurfacePatch>& patches) {
  ParallelFor(patches.size(), 64, [&](size_t i) {
    SurfacePatch& patch = patches[i];
    patch.looks.clear();
    for (const PatchView& seen : patch.views) {
      if (patch.looks.size() >= kMaxLooks) break;
      if (Mirrors(scene.views[seen.view], lights, patch)) continue;
      if (const auto rgb = colors.Mean(seen.view, seen.px.cast<double>(), seen.radius_px))
        patch.looks.push_back({seen.view, *rgb});
    }
  });
}

}  // namespace glint
