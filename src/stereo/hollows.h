// Hollows that a surface spans instead of lining: where the views that look at it do not see one and the same thing.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "colmap/scene.h"
#include "core/progress.h"
#include "geometry/triangle_mesh.h"
#include "highlights/sight_colors.h"

namespace glint {

struct HollowSummary {
  size_t num_known = 0;     // faces around known places that enough views see
  size_t num_doubtful = 0;  // faces whose colours the views disagree on
  size_t num_hollows = 0;
};

// Faces far less alike in the views than the surface around the places in `known` (world) are no surface. From them
// space is carved inward (Kutulakos & Seitz 2000, on voxels of 1/160 of the diagonal) as long as it looks less alike
// than nine tenths of the known surface do; walls of other faces stay. The views' median decides, so that highlights,
// which few views see at one place, do not. The closed mesh of what is carved, which stands out of the surface by some
// voxels where it begins; empty if there is nothing, or too little of the surface is known.
TriangleMesh FindHollows(const Scene& scene, const SightColors& colors, const TriangleMesh& mesh,
                         const std::vector<Eigen::Vector3d>& known, HollowSummary* summary = nullptr,
                         Progress& progress = Progress::Silent());

}  // namespace glint
