// How much a surface bends.
#pragma once

#include <vector>

#include "geometry/triangle_mesh.h"

namespace glint {

// Mean curvature at every vertex, 1 / length, from the vertex normals: half their divergence over the faces around,
// positive where the surface bulges outward (1/r on a sphere). 0 where no face has an area. The mesh needs normals.
std::vector<double> MeanCurvature(const TriangleMesh& mesh);

}  // namespace glint
