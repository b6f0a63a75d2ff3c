#include "tests/benchmark/seeds/poisson_peer.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/compute_average_spacing.h>
#include <CGAL/pca_estimate_normals.h>
#include <CGAL/poisson_surface_reconstruction.h>
#include <CGAL/property_map.h>

#include <utility>

namespace glint::benchmark {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using PointNormal = std::pair<Kernel::Point_3, Kernel::Vector_3>;
using PointMap = CGAL::First_of_pair_property_map<PointNormal>;
using NormalMap = CGAL::Second_of_pair_property_map<PointNormal>;

constexpr unsigned kNeighbors = 12;

}  // namespace

TriangleMesh PoissonSurface(const std::vector<Eigen::Vector3d>& points, const std::vector<Eigen::Vector3d>& toward) {
  std::vector<PointNormal> cloud;
  for (const Eigen::Vector3d& p : points) cloud.emplace_back(Kernel::Point_3(p.x(), p.y(), p.z()), Kernel::Vector_3());
  const auto maps = CGAL::parameters::point_map(PointMap()).normal_map(NormalMap());
  CGAL::pca_estimate_normals<CGAL::Sequential_tag>(cloud, kNeighbors, maps);
  for (size_t i = 0; i < cloud.size(); ++i) {
    Kernel::Vector_3& n = cloud[i].second;
    if (n.x() * toward[i].x() + n.y() * toward[i].y() + n.z() * toward[i].z() < 0) n = -n;
  }
  const double spacing = CGAL::compute_average_spacing<CGAL::Sequential_tag>(cloud, 6, maps);
  CGAL::Surface_mesh<Kernel::Point_3> surface;
  TriangleMesh mesh;
  if (!CGAL::poisson_surface_reconstruction_delaunay(cloud.begin(), cloud.end(), PointMap(), NormalMap(), surface,
                                                     spacing))
    return mesh;
  for (const auto v : surface.vertices()) {
    const Kernel::Point_3& p = surface.point(v);
    mesh.vertices.emplace_back(p.x(), p.y(), p.z());
  }
  for (const auto f : surface.faces()) {
    Eigen::Vector3i face;
    int k = 0;
    for (const auto v : surface.vertices_around_face(surface.halfedge(f)))
      face[k++] = static_cast<int>(static_cast<unsigned>(v));
    mesh.faces.push_back(face);
  }
  // CGAL's faces may look inward.
  if (SignedVolume(mesh) < 0)
    for (Eigen::Vector3i& f : mesh.faces) std::swap(f[0], f[1]);
  return mesh;
}

}  // namespace glint::benchmark
