// Holes through the object that its sparse surface spans, as nothing that is seen through them has points.
#pragma once

#include "geometry/triangle_mesh.h"
#include "silhouette/silhouettes.h"

namespace glint {

// The closed mesh, one piece, with a tunnel wherever several photographs look through it (Silhouettes::SeenThroughBy);
// as it is if there are none, or if what they look through does not lead out on the other side. `voxel`, `rounding`: of
// the tunnels' walls and edges, world units.
TriangleMesh WithSpannedHoles(const Silhouettes& silhouettes, const TriangleMesh& mesh, double voxel, double rounding);

}  // namespace glint
