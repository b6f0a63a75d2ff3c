// Samples of equal area on a mesh, the same ones every time.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "geometry/triangle_mesh.h"

namespace glint {

struct AreaSample {
  Eigen::Vector3d position;
  Eigen::Vector3d weights;  // barycentric
  int face;
};

// `count` samples, each for the same area: a stratified walk along the cumulative area with an R2 sequence inside the
// triangles (Roberts 2018). Faces without area get none.
std::vector<AreaSample> SampleSurface(const TriangleMesh& mesh, int count);

}  // namespace glint
