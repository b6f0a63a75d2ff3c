// A level set made anew: true distances again, another band, another resolution.
#pragma once

#include "sdf/level_set.h"

namespace glint {

// Signed distance to the zero set of `level_set`, on the same voxels, with the given half width.
LevelSet Redistance(const LevelSet& level_set, double half_width_voxels);

// Signed distance to the zero set of `level_set` on voxels of another size.
LevelSet Resample(const LevelSet& level_set, double new_voxel_size_world, double half_width_voxels);

}  // namespace glint
