// Paint stays bright at its place on the surface; the place of a highlight goes dark in the other views.
#pragma once

#include <optional>

#include "colmap/scene.h"
#include "highlights/highlight.h"
#include "highlights/seed_surface.h"
#include "highlights/view_brightness.h"
#include "light/light.h"

namespace glint {

struct PaintTestOptions {
  double min_half_change_deg;
  int min_other_views;
};

// How much of the highlight's rise over its surroundings the same surface point keeps in the median of the other views:
// about 0 for a highlight, about 1 for paint; the largest such median over depths within the seed's error along the
// ray, since at a wrong depth paint goes dark too. Compared are the views that see the point unoccluded, in which
// `light`'s half vector differs by at least min_half_change_deg, and in which the place that the depth leads to is not
// one that mirrors the light anyway: there a broad lobe would pass for paint. A null light stands for a distant one
// that the seed mirrors at the highlight. Under a light that moves with the camera paint is shaded as Lambert has it.
// nullopt: fewer than min_other_views of them.
std::optional<double> KeptBrightness(const Scene& scene, const ViewBrightness& brightness, const SeedSurface& surface,
                                     const Light* light, const Highlight& highlight, const SurfaceSample& at,
                                     const PaintTestOptions& options);

}  // namespace glint
