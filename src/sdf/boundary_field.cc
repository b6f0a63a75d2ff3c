#include "sdf/boundary_field.h"

#include <cmath>
#include <cstdlib>
#include <limits>
#include <numbers>

#include "geometry/closest_point.h"
#include "geometry/edge_topology.h"

namespace glint::internal {

BoundaryField::BoundaryField(const TriangleMesh& mesh) {
  const EdgeTopology topology = BuildEdgeTopology(mesh);
  edges_.vertices = mesh.vertices;
  for (size_t e = 0; e < topology.num_edges(); ++e) {
    int surplus = 0, low = 0, high = 0;
    for (uint32_t c : topology.CornersOf(e)) {
      const int a = mesh.faces[c / 3][c % 3], b = mesh.faces[c / 3][(c % 3 + 1) % 3];
      surplus += a < b ? 1 : -1;
      low = std::min(a, b), high = std::max(a, b);
    }
    if (surplus == 0) continue;
    edges_.faces.emplace_back(low, high, high);
    weights_.push_back(std::abs(surplus) * (mesh.vertices[low] - mesh.vertices[high]).norm());
  }
  bvh_ = std::make_unique<Bvh>(edges_);
  const std::vector<Bvh::Node>& nodes = bvh_->nodes();
  node_weights_.resize(nodes.size());
  for (size_t i = nodes.size(); i-- > 0;) {  // children come after their parents
    const Bvh::Node& node = nodes[i];
    for (uint32_t k = node.first; k < node.first + node.count; ++k) node_weights_[i] += weights_[bvh_->faces()[k]];
    if (node.count == 0) node_weights_[i] = node_weights_[i + 1] + node_weights_[node.right];
  }
}

double BoundaryField::GradientBound(const Eigen::Vector3d& center, double radius) const {
  if (empty()) return 0;
  const std::vector<Bvh::Node>& nodes = bvh_->nodes();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  uint32_t stack[64];
  int top = 0;
  stack[top++] = 0;
  double sum = 0;
  while (top > 0) {
    const uint32_t index = stack[--top];
    const Bvh::Node& node = nodes[index];
    const double distance = std::sqrt(node.SquaredDistance(center)) - radius;
    if (distance > 2 * (node.max - node.min).norm()) {
      sum += node_weights_[index] / (distance * distance);
      continue;
    }
    for (uint32_t k = node.first; k < node.first + node.count; ++k) {
      const uint32_t e = bvh_->faces()[k];
      const Eigen::Vector3d &a = edges_.vertices[edges_.faces[e][0]], &b = edges_.vertices[edges_.faces[e][1]];
      const double near = std::sqrt(ClosestOnTriangle(a, b, b, center).squared_distance) - radius;
      if (near <= 0) return kInfinity;
      sum += weights_[e] / (near * near);
    }
    if (node.count > 0) continue;
    stack[top++] = node.right;
    stack[top++] = index + 1;
  }
  return sum / (4 * std::numbers::pi);
}

}  // namespace glint::internal
