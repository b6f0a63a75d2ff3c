// Fewer triangles for pictures of a surface.
#pragma once

#include <cstddef>

#include "geometry/triangle_mesh.h"

namespace glint {

// At most about `max_faces` faces by edge collapse (Lindstrom, Turk 1998, by CGAL), least error first. Positions and
// faces only. Where faces do not fit together as a manifold, they are taken apart. A mesh that is small enough comes
// back without its attributes. Deterministic.
TriangleMesh Simplify(const TriangleMesh& mesh, size_t max_faces);

}  // namespace glint
