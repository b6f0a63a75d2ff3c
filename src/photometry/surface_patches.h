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

struct PatchLook {
  uint32_t view;
  Eigen::Array3d rgb;  // linear, the mean over the patch, 1 = sensor white
};

struct SurfacePatch {
  Eigen::Vector3d position, normal;  // world; on the surface, outward
  double radius_world = 0;
  std::vector<PatchLook> looks;
};

// One patch in every cell of a grid through which the surface passes; as wide as the cells. The mesh has normals. Looks
// are the squarest of those in which no light is mirrored anywhere near the patch: its gloss is dark there.
std::vector<SurfacePatch> LookAtSurface(const TriangleMesh& surface, const Scene& scene, const ViewColors& colors,
                                        const std::vector<Light>& lights, double spacing_world);

}  // namespace glint
