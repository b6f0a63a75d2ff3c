// Pictures of level sets, by rays through the volume.
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/picture_view.h"
#include "sdf/level_set.h"

namespace glint {

// The shaded surface φ = iso_world: sRGB, three bytes a pixel, rows from the top. Rays skip empty tiles, step by the
// distance that the field itself tells, and find the crossing in the tricubic field. Throws InputError unless
// |iso_world| is below the half width of the band. Deterministic.
std::vector<uint8_t> RenderLevelSet(const LevelSet& level_set, const PictureView& view, double iso_world = 0,
                                    const Look& look = {});

}  // namespace glint
