#include "seed/remesh.h"

#include <CGAL/Polygon_mesh_processing/remesh.h>

#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "core/check.h"
#include "core/parallel.h"
#include "geometry/closest_point.h"
#include "seed/surface_mesh.h"

namespace glint {
namespace {

constexpr int kHalvings = 5;  // of a move that turns a face over

// Per vertex the faces around it.
std::vector<std::vector<int>> FacesAround(const TriangleMesh& mesh) {
  std::vector<std::vector<int>> around(mesh.vertices.size());
  for (size_t f = 0; f < mesh.faces.size(); ++f)
    for (int k = 0; k < 3; ++k) around[mesh.faces[f][k]].push_back(static_cast<int>(f));
  return around;
}

// Where the middle of its neighbours lies, in the tangent plane; nothing where all faces around are without area.
std::optional<Eigen::Vector3d> Relaxed(const TriangleMesh& mesh, const std::vector<int>& around, int vertex) {
  Eigen::Vector3d normal = Eigen::Vector3d::Zero(), middle = Eigen::Vector3d::Zero();
  for (const int f : around) {
    normal += FaceNormal(mesh, f);
    // Every neighbour is a corner of two of the faces.
    for (int k = 0; k < 3; ++k)
      if (mesh.faces[f][k] != vertex) middle += mesh.vertices[mesh.faces[f][k]];
  }
  if (!(normal.norm() > 0)) return std::nullopt;
  normal.normalize();
  middle /= 2.0 * static_cast<double>(around.size());
  return middle + normal.dot(mesh.vertices[vertex] - middle) * normal;
}

// Tangential relaxation [Botsch, Kobbelt 2004] and the way back to the surface. CGAL 5.5's own reads beside its arrays
// where all faces around a vertex are without area.
void Relax(const ClosestPointQuery& original, TriangleMesh& mesh) {
  const std::vector<std::vector<int>> around = FacesAround(mesh);
  std::vector<std::optional<Eigen::Vector3d>> relaxed(mesh.vertices.size());
  ParallelFor(relaxed.size(), 256, [&](size_t v) { relaxed[v] = Relaxed(mesh, around[v], static_cast<int>(v)); });
  for (size_t v = 0; v < relaxed.size(); ++v) {
    if (!relaxed[v]) continue;
    const Eigen::Vector3d from = mesh.vertices[v];
    std::vector<Eigen::Vector3d> normals;
    for (const int f : around[v]) normals.push_back(FaceNormal(mesh, f));
    const auto turned = [&] {
      for (size_t i = 0; i < normals.size(); ++i)
        if (FaceNormal(mesh, around[v][i]).dot(normals[i]) < 0) return true;
      return false;
    };
    double share = 1;
    int halvings = 0;
    mesh.vertices[v] = *relaxed[v];
    while (turned() && halvings++ < kHalvings) {
      share /= 2;
      mesh.vertices[v] = from + share * (*relaxed[v] - from);
    }
    if (halvings > kHalvings) mesh.vertices[v] = from;
  }
  ParallelFor(relaxed.size(), 256, [&](size_t v) { mesh.vertices[v] = original.Find(mesh.vertices[v])->point; });
}

}  // namespace

TriangleMesh RemeshEvenly(const TriangleMesh& mesh, double edge_length, int iterations) {
  namespace pmp = CGAL::Polygon_mesh_processing;
  GLINT_CHECK_GT(edge_length, 0);
  const ClosestPointQuery original(mesh);
  TriangleMesh out = mesh;
  for (int i = 0; i < iterations; ++i) {
    internal::CgalMesh surface = internal::ToCgal(out);
    pmp::isotropic_remeshing(surface.faces(), edge_length, surface,
                             pmp::parameters::number_of_iterations(1).number_of_relaxation_steps(0).do_project(false));
    surface.collect_garbage();
    out = internal::FromCgal(surface);
    Relax(original, out);
  }
  return out;
}

}  // namespace glint
