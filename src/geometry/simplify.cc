#include "geometry/simplify.h"

#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Count_stop_predicate.h>
#include <CGAL/Surface_mesh_simplification/edge_collapse.h>

#include <array>

namespace glint {
namespace {

using Point = CGAL::Simple_cartesian<double>::Point_3;
using Surface = CGAL::Surface_mesh<Point>;

Surface ToSurface(const TriangleMesh& mesh) {
  Surface surface;
  const auto add_vertex = [&](int v) {
    const Eigen::Vector3d& x = mesh.vertices[static_cast<size_t>(v)];
    return surface.add_vertex(Point(x.x(), x.y(), x.z()));
  };
  for (size_t v = 0; v < mesh.vertices.size(); ++v) add_vertex(static_cast<int>(v));
  for (const Eigen::Vector3i& f : mesh.faces) {
    using Vertex = Surface::Vertex_index;
    const auto at = [](int v) { return Vertex(static_cast<Vertex::size_type>(v)); };
    if (surface.add_face(at(f[0]), at(f[1]), at(f[2])).is_valid()) continue;
    // A third face on an edge, or one turned around: it gets corners of its own.
    surface.add_face(add_vertex(f[0]), add_vertex(f[1]), add_vertex(f[2]));
  }
  return surface;
}

TriangleMesh FromSurface(const Surface& surface) {
  TriangleMesh mesh;
  for (const auto v : surface.vertices()) {
    const Point& x = surface.point(v);
    mesh.vertices.emplace_back(x.x(), x.y(), x.z());
  }
  for (const auto f : surface.faces()) {
    Eigen::Vector3i& face = mesh.faces.emplace_back();
    int k = 0;
    for (const auto v : surface.vertices_around_face(surface.halfedge(f)))
      face[k++] = static_cast<int>(static_cast<unsigned>(v));
  }
  return WithoutUnusedVertices(mesh);
}

}  // namespace

TriangleMesh Simplify(const TriangleMesh& mesh, size_t max_faces) {
  Surface surface = ToSurface(mesh);
  if (mesh.faces.size() > max_faces) {
    namespace sms = CGAL::Surface_mesh_simplification;
    // Of a triangulated surface there are three edges for two faces.
    sms::edge_collapse(surface, sms::Count_stop_predicate<Surface>(max_faces + max_faces / 2));
    surface.collect_garbage();
  }
  return FromSurface(surface);
}

}  // namespace glint
