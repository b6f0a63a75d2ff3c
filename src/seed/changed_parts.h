// Rims and hollows, which are cut out of voxels, as smooth as what is known of them allows.
#pragma once

#include <vector>

#include "colmap/scene.h"
#include "geometry/triangle_mesh.h"
#include "silhouette/outline.h"

namespace glint {

// Where `mesh`, with its vertices spread evenly, is not as it was `before` it was changed, it bends as little as it
// can: a thin plate that joins the rest smoothly and touches the rays through the outlines that it nearly touches now.
// With `stay_world` > 0 it also stays where it is, but for what is narrower than that. World units. The mesh as it is
// if that passed through itself.
TriangleMesh SmoothChangedParts(const Scene& scene, const std::vector<OutlineSample>& outline,
                                const TriangleMesh& before, const TriangleMesh& mesh, double stay_world);

}  // namespace glint
