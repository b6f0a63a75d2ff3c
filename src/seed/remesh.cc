#include "seed/remesh.h"

#include <CGAL/Polygon_mesh_processing/remesh.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>

#include "core/check.h"

namespace glint {

TriangleMesh RemeshEvenly(const TriangleMesh& mesh, double edge_length, int iterations) {
  using Point = CGAL::Simple_cartesian<double>::Point_3;
  namespace pmp = CGAL::Polygon_mesh_processing;
  GLINT_CHECK_GT(edge_length, 0);
  CGAL::Surface_mesh<Point> surface;
  for (const Eigen::Vector3d& v : mesh.vertices) surface.add_vertex(Point(v.x(), v.y(), v.z()));
  using Vertex = CGAL::Surface_mesh<Point>::Vertex_index;
  for (const Eigen::Vector3i& f : mesh.faces) {
    const auto added = surface.add_face(Vertex(f[0]), Vertex(f[1]), Vertex(f[2]));
    GLINT_CHECK(added.is_valid());
  }
  pmp::isotropic_remeshing(surface.faces(), edge_length, surface, pmp::parameters::number_of_iterations(iterations));
  surface.collect_garbage();
  TriangleMesh out;
  for (const Vertex v : surface.vertices()) {
    const Point& p = surface.point(v);
    out.vertices.emplace_back(p.x(), p.y(), p.z());
  }
  for (const auto f : surface.faces()) {
    Eigen::Vector3i face;
    int k = 0;
    for (const Vertex v : surface.vertices_around_face(surface.halfedge(f)))
      face[k++] = static_cast<int>(static_cast<unsigned>(v));
    out.faces.push_back(face);
  }
  return out;
}

}  // namespace glint
