// Sorts patches of a surface by their colour.
#pragma once

#include <cstddef>
#include <vector>

#include "photometry/surface_patches.h"

namespace glint {

// Indices of the patches of each material, the largest first: those whose chromaticities (the shares of red and green
// in the median over their looks) lie about one of the chromaticities' modes. What belongs to none, and patches
// without a look, are in none.
std::vector<std::vector<size_t>> SortIntoMaterials(const std::vector<SurfacePatch>& patches);

}  // namespace glint
