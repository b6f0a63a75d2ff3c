#include "geometry/pseudo_normals.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>

#include "core/parallel.h"

namespace glint {

namespace {

__extension__ using Quad = __float128;

// The cross product of (b − a) and (c − a) in quadruple precision, scaled into double.
Eigen::Vector3d QuadCross(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  Quad u[3], v[3], n[3];
  for (int k = 0; k < 3; ++k) {
    u[k] = Quad(b[k]) - Quad(a[k]);
    v[k] = Quad(c[k]) - Quad(a[k]);
  }
  Quad largest = 0;
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    n[k] = u[i] * v[j] - u[j] * v[i];
    largest = std::max(largest, n[k] < 0 ? -n[k] : n[k]);
  }
  if (largest == 0) return Eigen::Vector3d::Zero();
  return {static_cast<double>(n[0] / largest), static_cast<double>(n[1] / largest),
          static_cast<double>(n[2] / largest)};
}

}  // namespace

Eigen::Vector3d AccurateNormal(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  const Eigen::Vector3d u = b - a, v = c - a;
  Eigen::Vector3d n = u.cross(v);
  // Where cancellation has eaten more than about seven digits.
  if (!(n.squaredNorm() > 1e-14 * u.squaredNorm() * v.squaredNorm())) n = QuadCross(a, b, c);
  const double length = n.norm();
  return length > 0 ? Eigen::Vector3d(n / length) : Eigen::Vector3d::Zero();
}

double CornerAngle(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  const Eigen::Vector3d u = b - a, v = c - a;
  return std::atan2(u.cross(v).norm(), u.dot(v));
}

namespace {

// The corners of faces at each vertex, ascending: corners[first[v]] … corners[first[v + 1]].
struct CornersAtVertices {
  std::vector<uint32_t> first, corners;
};

CornersAtVertices SortCorners(const TriangleMesh& mesh) {
  const size_t num_vertices = mesh.vertices.size(), num_faces = mesh.faces.size();
  CornersAtVertices out;
  std::vector<uint32_t> next(num_vertices + 1, 0);
  const auto slot = [&](size_t f, int k) { return std::atomic_ref<uint32_t>(next[mesh.faces[f][k]]); };
  ParallelFor(num_faces, 8192, [&](size_t f) {
    for (int k = 0; k < 3; ++k) slot(f, k).fetch_add(1, std::memory_order_relaxed);
  });
  out.first.resize(num_vertices + 1);
  std::exclusive_scan(next.begin(), next.end(), out.first.begin(), 0u);
  std::copy(out.first.begin(), out.first.end(), next.begin());
  out.corners.resize(3 * num_faces);
  ParallelFor(num_faces, 8192, [&](size_t f) {
    for (int k = 0; k < 3; ++k)
      out.corners[slot(f, k).fetch_add(1, std::memory_order_relaxed)] = static_cast<uint32_t>(3 * f) + k;
  });
  // The threads came in any order; sums must not depend on it.
  ParallelFor(num_vertices, 8192,
              [&](size_t v) { std::sort(out.corners.begin() + out.first[v], out.corners.begin() + out.first[v + 1]); });
  return out;
}

}  // namespace

PseudoNormals ComputePseudoNormals(const TriangleMesh& mesh, const EdgeTopology& topology) {
  PseudoNormals out;
  const size_t num_faces = mesh.faces.size(), num_vertices = mesh.vertices.size();
  out.face.resize(num_faces);
  out.edge.resize(num_faces);
  ParallelFor(num_faces, 4096, [&](size_t f) {
    const Eigen::Vector3i& face = mesh.faces[f];
    out.face[f] = AccurateNormal(mesh.vertices[face[0]], mesh.vertices[face[1]], mesh.vertices[face[2]]);
  });
  ParallelFor(topology.num_edges(), 4096, [&](size_t e) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (uint32_t c : topology.CornersOf(e)) sum += out.face[c / 3];
    for (uint32_t c : topology.CornersOf(e)) out.edge[c / 3][c % 3] = sum;
  });
  const CornersAtVertices at = SortCorners(mesh);
  out.vertex.resize(num_vertices);
  ParallelFor(num_vertices, 4096, [&](size_t v) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (uint32_t i = at.first[v]; i < at.first[v + 1]; ++i) {
      const uint32_t c = at.corners[i];
      const Eigen::Vector3i& face = mesh.faces[c / 3];
      sum += CornerAngle(mesh.vertices[v], mesh.vertices[face[(c % 3 + 1) % 3]], mesh.vertices[face[(c % 3 + 2) % 3]]) *
             out.face[c / 3];
    }
    out.vertex[v] = sum;
  });
  return out;
}

}  // namespace glint
