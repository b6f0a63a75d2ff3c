// Shape from shading with known lights: how bright the matte base is says how its normal stands to the light, also
// where no highlight passes [Horn 1970].
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "colmap/scene.h"
#include "geometry/triangle_mesh.h"
#include "light/light.h"
#include "photometry/surface_patches.h"
#include "photometry/tilt.h"

namespace glint {

// What is matte and of one colour.
struct Material {
  size_t num_patches = 0;
  double scatter = 0;   // of the brightness about what the fit says, relative
  double contrast = 0;  // of what the fit says, relative; shading is used where it is well above the scatter
  bool used = false;
};

struct ShadingTilts {
  std::vector<Tilt> tilts;
  std::vector<Material> materials;
};

// Patches (with their looks) are sorted by chromaticity into materials. In each, brightness is fitted as
//   b = a₀ + g·n + Σ eₗ (irradiance of light l)·n,
// a₀ and g being the light of the surroundings to first order, with the surface's own normals n, which are right on
// average; what does not fit (marks, prints, what a shadow's edge passes) is given little weight. Solved for the
// normal, the same equation then is a Tilt. Cast shadows are those that the surface throws; patches near an edge of a
// shadow are left out. Nothing is said where the brightness does not follow the normals.
ShadingTilts TiltsFromShading(const TriangleMesh& surface, const Scene& scene, const std::vector<Light>& lights,
                              const std::vector<SurfacePatch>& patches);

}  // namespace glint
