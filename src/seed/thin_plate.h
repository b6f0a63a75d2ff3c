// The bending energy of a surface mesh, as matrices.
#pragma once

#include <Eigen/SparseCore>

#include "geometry/triangle_mesh.h"

namespace glint {

using SparseMatrix = Eigen::SparseMatrix<double>;

// Cotangent weights, within what nearly equilateral triangles have: a sliver must neither turn them negative nor
// dominate. For meshes of even vertices.
struct EvenLaplacian {
  SparseMatrix stiffness;  // symmetric, rows sum to zero
  double area = 0;         // a vertex, world units squared
};

EvenLaplacian MakeEvenLaplacian(const TriangleMesh& mesh);

// λ Lᵀ A⁻¹ L: the matrix of λ ∫‖Δx‖².
SparseMatrix ThinPlate(const EvenLaplacian& laplacian, double lambda);

}  // namespace glint
