// Between our meshes and CGAL's. Only for .cc files of this module: it brings CGAL along.
#pragma once

#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>

#include "core/check.h"
#include "geometry/triangle_mesh.h"

namespace glint::internal {

using CgalPoint = CGAL::Simple_cartesian<double>::Point_3;
using CgalMesh = CGAL::Surface_mesh<CgalPoint>;

// The mesh must be manifold.
inline CgalMesh ToCgal(const TriangleMesh& mesh) {
  CgalMesh out;
  for (const Eigen::Vector3d& v : mesh.vertices) out.add_vertex(CgalPoint(v.x(), v.y(), v.z()));
  using Vertex = CgalMesh::Vertex_index;
  for (const Eigen::Vector3i& f : mesh.faces)
    GLINT_CHECK(out.add_face(Vertex(f[0]), Vertex(f[1]), Vertex(f[2])).is_valid());
  return out;
}

// Without garbage (collect_garbage). Positions and faces only.
inline TriangleMesh FromCgal(const CgalMesh& mesh) {
  TriangleMesh out;
  for (const auto v : mesh.vertices()) {
    const CgalPoint& p = mesh.point(v);
    out.vertices.emplace_back(p.x(), p.y(), p.z());
  }
  for (const auto f : mesh.faces()) {
    Eigen::Vector3i face;
    int k = 0;
    for (const auto v : mesh.vertices_around_face(mesh.halfedge(f)))
      face[k++] = static_cast<int>(static_cast<unsigned>(v));
    out.faces.push_back(face);
  }
  return out;
}

}  // namespace glint::internal
