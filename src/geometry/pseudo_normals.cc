#include "geometry/pseudo_normals.h"

#include <cmath>

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

double Angle(const Eigen::Vector3d& u, const Eigen::Vector3d& v) { return std::atan2(u.cross(v).norm(), u.dot(v)); }

}  // namespace

Eigen::Vector3d AccurateNormal(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  const Eigen::Vector3d u = b - a, v = c - a;
  Eigen::Vector3d n = u.cross(v);
  // Where cancellation has eaten more than about seven digits.
  if (!(n.squaredNorm() > 1e-14 * u.squaredNorm() * v.squaredNorm())) n = QuadCross(a, b, c);
  const double length = n.norm();
  return length > 0 ? Eigen::Vector3d(n / length) : Eigen::Vector3d::Zero();
}

PseudoNormals ComputePseudoNormals(const TriangleMesh& mesh, const EdgeTopology& topology) {
  PseudoNormals out;
  const size_t num_faces = mesh.faces.size(), num_vertices = mesh.vertices.size();
  out.face.resize(num_faces);
  out.edge.resize(num_faces);
  std::vector<std::array<double, 3>> angles(num_faces);
  ParallelFor(num_faces, 4096, [&](size_t f) {
    const Eigen::Vector3i& face = mesh.faces[f];
    const Eigen::Vector3d* x[3] = {&mesh.vertices[face[0]], &mesh.vertices[face[1]], &mesh.vertices[face[2]]};
    out.face[f] = AccurateNormal(*x[0], *x[1], *x[2]);
    for (int k = 0; k < 3; ++k) angles[f][k] = Angle(*x[(k + 1) % 3] - *x[k], *x[(k + 2) % 3] - *x[k]);
  });
  ParallelFor(topology.num_edges(), 4096, [&](size_t e) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (uint32_t c : topology.CornersOf(e)) sum += out.face[c / 3];
    for (uint32_t c : topology.CornersOf(e)) out.edge[c / 3][c % 3] = sum;
  });
  out.vertex.assign(num_vertices, Eigen::Vector3d::Zero());
  for (size_t f = 0; f < num_faces; ++f)
    for (int k = 0; k < 3; ++k) out.vertex[mesh.faces[f][k]] += angles[f][k] * out.face[f];
  return out;
}

}  // namespace glint
