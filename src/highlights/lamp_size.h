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

// How far the middle of the extended lamp may be off its highlights' middle: a part of light.sigma, and in its units; 0
// for a small one. `center`: of the object.
double CentroidSigma(const std::vector<View>& views, const Eigen::Vector3d& center, const FoundLight& found);

// How wide the lobes of its highlights are (mirror_test.h), degrees; of those that lie on the seed.
std::vector<double> WidthsDeg(const Scene& scene, const SeedSurface& surface, const std::vector<Highlight>& highlights,
                              const Light& light);

}  // namespace glint
