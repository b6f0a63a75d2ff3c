// A smooth surface through the vertices of a coarse mesh.
#pragma once

#include "geometry/triangle_mesh.h"

namespace glint {

// Loop subdivision (by CGAL), `times` times: each makes a face four. The control points are set so that the limit
// surface passes near the mesh's own vertices, else it would shrink. The mesh must be closed and manifold. Positions
// and faces only.
TriangleMesh SubdivideSmoothly(const TriangleMesh& mesh, int times);

}  // namespace glint
