#include "geometry/winding_number.h"

#include <cmath>
#include <numbers>

#include "core/parallel.h"

namespace glint {

namespace {

// Solid angle of the triangle abc seen from p; positive if p is behind it.
double SolidAngle(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                  const Eigen::Vector3d& p) {
  const Eigen::Vector3d u = a - p, v = b - p, w = c - p;
  const double x = u.norm(), y = v.norm(), z = w.norm();
  const double sine = u.dot(v.cross(w));
  const double cosine = x * y * z + u.dot(v) * z + v.dot(w) * x + w.dot(u) * y;
  return sine == 0 && cosine == 0 ? 0 : 2 * std::atan2(sine, cosine);
}

double FaceSolidAngle(const TriangleMesh& mesh, size_t f, const Eigen::Vector3d& p) {
  const Eigen::Vector3i& face = mesh.faces[f];
  return SolidAngle(mesh.vertices[face[0]], mesh.vertices[face[1]], mesh.vertices[face[2]], p);
}

}  // namespace

double ExactWindingNumber(const TriangleMesh& mesh, const Eigen::Vector3d& p) {
  double sum = 0;
  for (size_t f = 0; f < mesh.faces.size(); ++f) sum += FaceSolidAngle(mesh, f, p);
  return sum / (4 * std::numbers::pi);
}

WindingNumber::WindingNumber(const TriangleMesh& mesh, const Bvh& bvh, double accuracy)
    : mesh_(&mesh), bvh_(&bvh), accuracy_(accuracy), moments_(bvh.nodes().size()) {
  const std::vector<Bvh::Node>& nodes = bvh.nodes();
  // The faces under a node are contiguous: from its leftmost leaf to its rightmost.
  ParallelFor(nodes.size(), 64, [&](size_t index) {
    size_t left = index, right = index;
    while (nodes[left].count == 0) ++left;
    while (nodes[right].count == 0) right = nodes[right].right;
    const uint32_t begin = nodes[left].first, end = nodes[right].first + nodes[right].count;
    Moments& m = moments_[index];
    m.center.setZero();
    double area_sum = 0;
    const auto corner = [&](uint32_t i, int k) -> const Eigen::Vector3d& {
      return mesh.vertices[mesh.faces[bvh.faces()[i]][k]];
    };
    const Eigen::Vector3d origin = (nodes[index].min + nodes[index].max) / 2;
    for (uint32_t i = begin; i < end; ++i) {
      const Eigen::Vector3d a = corner(i, 0) - origin, b = corner(i, 1) - origin, c = corner(i, 2) - origin;
      const double area = (b - a).cross(c - a).norm();
      m.center += area * (a + b + c) / 3;
      area_sum += area;
    }
    m.center = area_sum > 0 ? Eigen::Vector3d(origin + m.center / area_sum) : origin;
    m.radius = 0;
    m.normal.setZero();
    m.first.setZero();
    for (Eigen::Matrix3d& s : m.second) s.setZero();
    for (uint32_t i = begin; i < end; ++i) {
      const Eigen::Vector3d a = corner(i, 0) - m.center, b = corner(i, 1) - m.center, c = corner(i, 2) - m.center;
      const Eigen::Vector3d normal = (b - a).cross(c - a) / 2, sum = a + b + c;
      m.radius = std::max({m.radius, a.norm(), b.norm(), c.norm()});
      m.normal += normal;
      m.first += normal * sum.transpose() / 3;
      const Eigen::Matrix3d moment =
          (a * a.transpose() + b * b.transpose() + c * c.transpose() + sum * sum.transpose()) / 24;
      for (int k = 0; k < 3; ++k) m.second[k] += normal[k] * moment;
    }
    m.contraction.setZero();
    for (int k = 0; k < 3; ++k) {
      m.trace[k] = m.second[k].trace();
      m.contraction += m.second[k].row(k).transpose();
    }
  });
}

double WindingNumber::operator()(const Eigen::Vector3d& p) const {
  if (bvh_->empty()) return 0;
  const std::vector<Bvh::Node>& nodes = bvh_->nodes();
  uint32_t stack[64];
  int top = 0;
  stack[top++] = 0;
  double sum = 0;
  while (top > 0) {
    const uint32_t index = stack[--top];
    const Bvh::Node& node = nodes[index];
    const Moments& m = moments_[index];
    const Eigen::Vector3d r = m.center - p;
    const double squared = r.squaredNorm();
    if (squared > accuracy_ * accuracy_ * m.radius * m.radius) {
      const double r1 = std::sqrt(squared), r3 = 1 / (r1 * squared), r5 = r3 / squared, r7 = r5 / squared;
      sum += r3 * (m.normal.dot(r) + m.first.trace()) - 3 * r5 * r.dot(m.first * r);
      double cubic = 0;
      for (int k = 0; k < 3; ++k) cubic += r[k] * r.dot(m.second[k] * r);
      sum += 15 * r7 * cubic - 3 * r5 * (r.dot(m.trace) + 2 * r.dot(m.contraction));
      continue;
    }
    for (uint32_t i = node.first; i < node.first + node.count; ++i) sum += FaceSolidAngle(*mesh_, bvh_->faces()[i], p);
    if (node.count > 0) continue;
    stack[top++] = node.right;
    stack[top++] = index + 1;
  }
  return sum / (4 * std::numbers::pi);
}

}  // namespace glint
