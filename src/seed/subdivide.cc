#include "seed/subdivide.h"

#include <CGAL/boost/graph/properties.h>
#include <CGAL/subdivision_method_3.h>

#include <cmath>

#include "seed/surface_mesh.h"

namespace glint {
namespace {

constexpr int kCorrections = 3;

// How much of a vertex' limit position each of its n neighbours makes (Loop 1987).
double LimitWeight(double n) {
  const double c = 3.0 / 8 + std::cos(2 * M_PI / n) / 4;
  const double beta = (5.0 / 8 - c * c) / n;
  return 1 / (n + 3 / (8 * beta));
}

// Control points whose limit surface passes (nearly) through `mesh`'s vertices.
std::vector<Eigen::Vector3d> ControlPoints(const TriangleMesh& mesh) {
  std::vector<Eigen::Vector3d> control = mesh.vertices;
  std::vector<int> valence(mesh.vertices.size(), 0);
  for (const Eigen::Vector3i& f : mesh.faces)
    for (int k = 0; k < 3; ++k) ++valence[f[k]];
  for (int round = 0; round < kCorrections; ++round) {
    std::vector<Eigen::Vector3d> sum(control.size(), Eigen::Vector3d::Zero());
    // On a closed, oriented mesh every edge leaves each of its ends once.
    for (const Eigen::Vector3i& f : mesh.faces)
      for (int k = 0; k < 3; ++k) sum[f[k]] += control[f[(k + 1) % 3]];
    for (size_t v = 0; v < control.size(); ++v) {
      if (valence[v] < 3) continue;
      const double w = LimitWeight(valence[v]);
      const Eigen::Vector3d limit = (1 - valence[v] * w) * control[v] + w * sum[v];
      control[v] += mesh.vertices[v] - limit;
    }
  }
  return control;
}

}  // namespace

TriangleMesh SubdivideSmoothly(const TriangleMesh& mesh, int times) {
  TriangleMesh control = mesh;
  control.vertices = ControlPoints(mesh);
  internal::CgalMesh surface = internal::ToCgal(control);
  CGAL::Subdivision_method_3::Loop_subdivision(surface, CGAL::parameters::number_of_iterations(times));
  return internal::FromCgal(surface);
}

}  // namespace glint
