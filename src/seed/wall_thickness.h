// Where nobody saw one side of a thin wall, it is about as thick as it is beside there.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "geometry/triangle_mesh.h"
#include "seed/thin_plate.h"

namespace glint {

// Where a vertex is to be, so that the wall is as thick as it is where both of its sides are known.
struct WallPlace {
  int vertex;
  Eigen::Vector3d position;
  double sigma;  // world units: how evenly thick the wall is where it is known; larger for what is known itself
};

// Of the less known side of a closed, oriented mesh. Thickness is measured along the inward normals to a side that
// faces the other way, and continued over the surface with `laplacian` over `length` (world units); as bending alone
// decides, a wall swells towards its rim. `known`: how well the surface is known at its vertices, 0 … 1. None if what
// is known is no wall (a tenth of `diagonal` thick at most, over a good share of the surface), or not evenly thick.
std::vector<WallPlace> WallPlaces(const TriangleMesh& mesh, const std::vector<Eigen::Vector3d>& normals,
                                  const EvenLaplacian& laplacian, const Eigen::VectorXd& known, double length,
                                  double diagonal);

}  // namespace glint
