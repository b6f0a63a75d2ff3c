// Small patches spread over a surface, with their colours in the photographs.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "colmap/scene.h"
#include "geometry/triangle_mesh.h"
#include "highlights/view_colors.h"
#include "light/light.h"

namespace glint {

// Where a patch is in a photograph.
struct PatchView {
  uint32_t view;
  Eigen::Vector2f px;
  float radius_px;
};

struct PatchLook {
  uint32_t view;
  Eigen::Array3d rgb;  // linear, the mean over the patch, 1 = sensor white
};

struct SurfacePatch {
  Eigen::Vector3d position, normal;  // world; on the surface, outward
  double radius_world = 0;
  std::vector<PatchView> views;  // that see it, the squarest first, at most 24 and none beyond 60 degrees
  std::vector<PatchLook> looks;
};

// One patch in every cell of a grid through which the surface passes; as wide as the cells. The mesh has normals.
// Without looks.
std::vector<SurfacePatch> SpreadPatches(const TriangleMesh& surface, const Scene& scene, double spacing_world);

// Whether a light is mirrored within 20 degrees of the patch's normal: its gloss may show there.
bool Mirrors(const View& view, const std::vector<Light>& lights, const SurfacePatch& patch);

// Takes the squarest of those looks in which no light is mirrored anywhere near the patch: its gloss is dark there.
void TakeLooks(const Scene& scene, const ViewColors& colors, const std::vector<Light>& lights,
               std::vector<SurfacePatch>& patches);

}  // namespace glint
