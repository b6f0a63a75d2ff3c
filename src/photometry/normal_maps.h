// What normal maps of the photographs say of the surface.
#pragma once

#include <cstddef>
#include <vector>

#include "colmap/scene.h"
#include "io/normal_source.h"
#include "photometry/surface_patches.h"
#include "photometry/tilt.h"

namespace glint {

struct GivenNormals {
  std::vector<Tilt> tilts;  // two a patch, across its normal
  size_t num_patches = 0;   // with a normal
  double scatter_deg = 0;   // of a single view's normal about its patch's, median: what one map is off by
};

// The normals of all views that see a patch, drawn together to the one that has the least sum of angles to the others
// and then to the mean of what agrees with it. Its standard deviation is the scatter divided by the square root of the
// number of views, of which four count at most: the maps of one network err alike.
GivenNormals TiltsFromNormalMaps(const NormalSource& maps, const Scene& scene,
                                 const std::vector<SurfacePatch>& patches);

}  // namespace glint
