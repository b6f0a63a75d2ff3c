#include "metrics/nearest_on_mesh.h"

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Simple_cartesian.h>

#include <array>

#include "core/check.h"

namespace glint {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Triangle = Kernel::Triangle_3;
using Iterator = std::vector<Triangle>::const_iterator;
using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, CGAL::AABB_triangle_primitive<Kernel, Iterator>>>;

Eigen::Vector3d Barycentric(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                            const Eigen::Vector3d& x) {
  const Eigen::Vector3d n = (b - a).cross(c - a);
  const double area2 = n.squaredNorm();
  if (!(area2 > 0)) return Eigen::Vector3d(1, 0, 0);
  Eigen::Vector3d w((c - b).cross(x - b).dot(n), (a - c).cross(x - c).dot(n), (b - a).cross(x - a).dot(n));
  w = (w / area2).cwiseMax(0.0);
  return w / w.sum();
}

}  // namespace

struct NearestFinder::Impl {
  const TriangleMesh& mesh;
  std::vector<Triangle> triangles;
  std::vector<int> face_of;  // faces without area are left out
  Tree tree;

  explicit Impl(const TriangleMesh& m) : mesh(m) {
    auto point = [&](int v) { return Kernel::Point_3(m.vertices[v].x(), m.vertices[v].y(), m.vertices[v].z()); };
    for (size_t f = 0; f < m.faces.size(); ++f) {
      const Triangle t(point(m.faces[f][0]), point(m.faces[f][1]), point(m.faces[f][2]));
      if (t.is_degenerate()) continue;
      triangles.push_back(t);
      face_of.push_back(static_cast<int>(f));
    }
    GLINT_CHECK(!triangles.empty());
    tree.insert(triangles.begin(), triangles.end());
    tree.build();
    tree.accelerate_distance_queries();
  }
};

NearestFinder::NearestFinder(const TriangleMesh& mesh) : impl_(std::make_unique<Impl>(mesh)) {}
NearestFinder::~NearestFinder() = default;

NearestOnMesh NearestFinder::Find(const Eigen::Vector3d& x) const {
  const auto [point, primitive] = impl_->tree.closest_point_and_primitive(Kernel::Point_3(x.x(), x.y(), x.z()));
  const int face = impl_->face_of[primitive - impl_->triangles.begin()];
  const Eigen::Vector3d p(point.x(), point.y(), point.z());
  const Eigen::Vector3i& f = impl_->mesh.faces[face];
  const auto& v = impl_->mesh.vertices;
  return {p, Barycentric(v[f[0]], v[f[1]], v[f[2]], p), face, (p - x).norm()};
}

}  // namespace glint
