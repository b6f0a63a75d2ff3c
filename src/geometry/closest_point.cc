#include "geometry/closest_point.h"

namespace glint {

namespace {

// Relative height under which a triangle is taken as its edges: its plane is then not known in double.
constexpr double kSliver = 1e-12;

// Closest point of the edge from corner k (at a) to corner k + 1 (at b).
TrianglePoint ClosestOnEdge(const Eigen::Vector3d& a, const Eigen::Vector3d& b, int k, const Eigen::Vector3d& p) {
  const Eigen::Vector3d ab = b - a;
  const double t = ab.dot(p - a);
  if (!(t > 0)) return {a, (p - a).squaredNorm(), Feature::kVertex, k};
  if (ab.dot(p - b) >= 0) return {b, (p - b).squaredNorm(), Feature::kVertex, (k + 1) % 3};
  const Eigen::Vector3d x = a + (t / ab.squaredNorm()) * ab;
  return {x, (p - x).squaredNorm(), Feature::kEdge, k};
}

}  // namespace

TrianglePoint ClosestOnTriangle(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                                const Eigen::Vector3d& p) {
  const Eigen::Vector3d corner[3] = {a, b, c};
  const Eigen::Vector3d edge[3] = {b - a, c - b, a - c};
  const Eigen::Vector3d n = edge[0].cross(edge[1]);
  const double longest = std::max({edge[0].squaredNorm(), edge[1].squaredNorm(), edge[2].squaredNorm()});
  const bool sliver = !(n.norm() > kSliver * longest);
  bool inside = !sliver;
  bool outside_of[3] = {sliver, sliver, sliver};
  for (int k = 0; k < 3 && !sliver; ++k) {
    outside_of[k] = !(n.cross(edge[k]).dot(p - corner[k]) > 0);
    inside = inside && !outside_of[k];
  }
  if (inside) {
    const Eigen::Vector3d r = (n.dot(p - a) / n.squaredNorm()) * n;
    return {p - r, r.squaredNorm(), Feature::kFace, 0};
  }
  // The closest boundary point lies on an edge that p is outside of.
  TrianglePoint best{a, std::numeric_limits<double>::infinity(), Feature::kVertex, 0};
  for (int k = 0; k < 3; ++k) {
    if (!outside_of[k]) continue;
    const TrianglePoint q = ClosestOnEdge(corner[k], corner[(k + 1) % 3], k, p);
    if (q.squared_distance < best.squared_distance) best = q;
  }
  return best;
}

Eigen::Vector3d Barycentric(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                            const Eigen::Vector3d& x) {
  const Eigen::Vector3d n = (b - a).cross(c - a);
  const double area = n.squaredNorm();
  if (area > 0) {
    const double u = n.dot((x - a).cross(c - a)) / area;
    const double v = n.dot((b - a).cross(x - a)) / area;
    return {1 - u - v, u, v};
  }
  // Along the longest edge of a triangle without area.
  const Eigen::Vector3d corner[3] = {a, b, c};
  int longest = 0;
  for (int k = 1; k < 3; ++k)
    if ((corner[(k + 1) % 3] - corner[k]).squaredNorm() > (corner[(longest + 1) % 3] - corner[longest]).squaredNorm())
      longest = k;
  const Eigen::Vector3d e = corner[(longest + 1) % 3] - corner[longest];
  Eigen::Vector3d weights = Eigen::Vector3d::Zero();
  const double t = e.squaredNorm() > 0 ? e.dot(x - corner[longest]) / e.squaredNorm() : 0;
  weights[longest] = 1 - t;
  weights[(longest + 1) % 3] = t;
  return weights;
}

std::optional<MeshPoint> ClosestPointQuery::Find(const Eigen::Vector3d& p, double max_distance, int near_face) const {
  if (bvh_.empty()) return std::nullopt;
  const std::vector<Bvh::Node>& nodes = bvh_.nodes();
  MeshPoint best{{p, max_distance * max_distance, Feature::kFace, 0}, -1};
  const auto look_at = [&](int f) {
    const Eigen::Vector3i& face = mesh_->faces[f];
    const Eigen::Vector3d &a = mesh_->vertices[face[0]], &b = mesh_->vertices[face[1]], &c = mesh_->vertices[face[2]];
    const Eigen::Vector3d low = a.cwiseMin(b).cwiseMin(c), high = a.cwiseMax(b).cwiseMax(c);
    if ((low - p).cwiseMax(p - high).cwiseMax(0.0).squaredNorm() > best.squared_distance) return;
    const TrianglePoint q = ClosestOnTriangle(a, b, c, p);
    const bool tie = q.squared_distance == best.squared_distance && (best.face < 0 || f < best.face);
    if (q.squared_distance < best.squared_distance || tie) best = {q, f};
  };
  if (near_face >= 0) look_at(near_face);
  struct Entry {
    uint32_t node;
    double squared_distance;
  };
  Entry stack[96];
  int top = 0;
  stack[top++] = {0, nodes[0].SquaredDistance(p)};
  while (top > 0) {
    const Entry entry = stack[--top];
    if (entry.squared_distance > best.squared_distance) continue;
    const Bvh::Node& node = nodes[entry.node];
    for (uint32_t i = node.first; i < node.first + node.count; ++i) look_at(static_cast<int>(bvh_.faces()[i]));
    if (node.count > 0) continue;
    Entry near{entry.node + 1, nodes[entry.node + 1].SquaredDistance(p)};
    Entry far{node.right, nodes[node.right].SquaredDistance(p)};
    if (far.squared_distance < near.squared_distance) std::swap(near, far);
    stack[top++] = far;
    stack[top++] = near;
  }
  if (best.face < 0) return std::nullopt;
  return best;
}

}  // namespace glint
