#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Simple_cartesian.h>

#include <cmath>
#include <vector>

#include "tests/benchmark/sdf/peers.h"

namespace glint::benchmark {

namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Point = Kernel::Point_3;
using Triangles = std::vector<Kernel::Triangle_3>;
using Primitive = CGAL::AABB_triangle_primitive<Kernel, Triangles::const_iterator>;
using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;

class CgalPeer : public PointPeer {
 public:
  CgalPeer(const TriangleMesh& mesh, const PseudoNormals& normals) : mesh_(mesh), normals_(normals) {
    triangles_.reserve(mesh.faces.size());
    const auto point = [&](int v) { return Point(mesh.vertices[v][0], mesh.vertices[v][1], mesh.vertices[v][2]); };
    for (const Eigen::Vector3i& f : mesh.faces) triangles_.emplace_back(point(f[0]), point(f[1]), point(f[2]));
    tree_.rebuild(triangles_.begin(), triangles_.end());
    tree_.build();
    tree_.accelerate_distance_queries();
  }
  std::string Name() const override { return "CGAL AABB + sign"; }

  void Distances(const Eigen::Vector3d* points, size_t n, double, double, float* out) const override {
    Tree::Point_and_primitive_id hint;
    for (size_t i = 0; i < n; ++i) {
      const Eigen::Vector3d& p = points[i];
      const Point query(p[0], p[1], p[2]);
      // The closest point of the point before bounds the search.
      hint = i == 0 ? tree_.closest_point_and_primitive(query) : tree_.closest_point_and_primitive(query, hint);
      const int face = static_cast<int>(hint.second - triangles_.begin());
      const Eigen::Vector3i& f = mesh_.faces[face];
      const MeshPoint at{ClosestOnTriangle(mesh_.vertices[f[0]], mesh_.vertices[f[1]], mesh_.vertices[f[2]], p), face};
      const double distance = std::sqrt(at.squared_distance);
      out[i] = static_cast<float>((p - at.point).dot(normals_.Of(mesh_, at)) < 0 ? -distance : distance);
    }
  }

 private:
  const TriangleMesh& mesh_;
  const PseudoNormals& normals_;
  Triangles triangles_;
  Tree tree_;
};

}  // namespace

std::unique_ptr<PointPeer> MakeCgalPeer(const TriangleMesh& mesh, const PseudoNormals& normals) {
  return std::make_unique<CgalPeer>(mesh, normals);
}

}  // namespace glint::benchmark
