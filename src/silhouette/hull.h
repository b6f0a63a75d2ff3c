// The space that most masks together leave room for. Only for .cc files of this module: it brings OpenCV along.
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "colmap/scene.h"
#include "geometry/triangle_mesh.h"
#include "silhouette/agreement.h"

namespace glint::internal {

// The visual hull within `reach`, above the ground, on a coarse grid (a 64th of the ball's diameter), of which a
// quarter of the masks that see a place, and set.contradictions at least, may know nothing: good enough to expect
// outlines by. Empty if nothing is left.
TriangleMesh HullOfMost(const Scene& scene, const std::vector<ViewMask>& masks, const Reach& reach,
                        const std::optional<Eigen::Hyperplane<double, 3>>& ground);

}  // namespace glint::internal
