// Triangles of even size and shape.
#pragma once

#include "geometry/triangle_mesh.h"

namespace glint {

// Isotropic remeshing (Botsch, Kobbelt 2004, by CGAL): edges of about `edge_length` (world units), vertices on the
// input's surface. The mesh must be closed and manifold; topology is kept. Positions and faces only.
TriangleMesh RemeshEvenly(const TriangleMesh& mesh, double edge_length, int iterations = 4);

}  // namespace glint
