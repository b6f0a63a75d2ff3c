// Extended lamps: how far across, from the flat tops of their highlights.
#pragma once

#include <vector>

#include "colmap/scene.h"
#include "highlights/highlight.h"
#include "highlights/seed_surface.h"
#include "light/found_light.h"

namespace glint {

// Sets the light's angular size if its highlights are flatter than a small lamp's on any gloss would be, and adds to
// its covariance what a lamp of that size leaves open: its centroid is known to a twentieth of it. `highlights`: those
// of the light; saturated and small ones do not say. `center`: of the object.
void MeasureSize(const Scene& scene, const SeedSurface& surface, const std::vector<Highlight>& highlights,
                 const Eigen::Vector3d& center, FoundLight& light);

// Median over its highlights of how wide the lobe is (mirror_test.h), degrees; 0: none of them lies on the seed.
double MedianWidthDeg(const Scene& scene, const SeedSurface& surface, const std::vector<Highlight>& highlights,
                      const Light& light);

}  // namespace glint
