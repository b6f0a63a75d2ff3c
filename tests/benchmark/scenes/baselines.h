// What Glint is measured beside: the same sparse points, and no highlights.
#pragma once

#include <vector>

#include "colmap/scene.h"
#include "geometry/triangle_mesh.h"

namespace glint::benchmark {

// The mesh after 0, 1, 2, 5, 10, 20 and 50 rounds of Laplacian smoothing (every vertex half way to its neighbours'
// mean).
std::vector<TriangleMesh> LaplacianSmoothed(const TriangleMesh& mesh);

// The zero set of its signed distance (voxels of `voxel_rel` diagonals) after so many steps of flow by mean curvature
// (refine/flow_step.h with nothing but curvature): 10, 30, 100 and 300.
std::vector<TriangleMesh> CurvatureFlowed(const TriangleMesh& mesh, double voxel_rel);

// CGAL's Poisson surface of the scene's points with used[i] != 0, their normals (principal components) turned to the
// cameras that see them. Empty if it fails.
TriangleMesh Poisson(const Scene& scene, const std::vector<uint8_t>& used);

}  // namespace glint::benchmark
