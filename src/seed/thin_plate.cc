#include "seed/thin_plate.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <vector>

namespace glint {
namespace {

constexpr double kMinCot = 0.05, kMaxCot = 3;

}  // namespace

EvenLaplacian MakeEvenLaplacian(const TriangleMesh& mesh) {
  const int n = static_cast<int>(mesh.vertices.size());
  EvenLaplacian out{SparseMatrix(n, n), SurfaceArea(mesh) / n};
  std::vector<Eigen::Triplet<double>> entries;
  for (const Eigen::Vector3i& f : mesh.faces)
    for (int k = 0; k < 3; ++k) {
      const int i = f[(k + 1) % 3], j = f[(k + 2) % 3];
      const Eigen::Vector3d a = mesh.vertices[i] - mesh.vertices[f[k]], b = mesh.vertices[j] - mesh.vertices[f[k]];
      const double area2 = a.cross(b).norm();
      const double w = 0.5 * std::clamp(area2 > 0 ? a.dot(b) / area2 : kMaxCot, kMinCot, kMaxCot);
      entries.insert(entries.end(), {{i, j, -w}, {j, i, -w}, {i, i, w}, {j, j, w}});
    }
  out.stiffness.setFromTriplets(entries.begin(), entries.end());
  return out;
}

SparseMatrix ThinPlate(const EvenLaplacian& laplacian, double lambda) {
  return SparseMatrix(laplacian.stiffness * laplacian.stiffness) * (lambda / laplacian.area);
}

}  // namespace glint
