#include "geometry/components.h"

#include <cmath>
#include <numeric>

#include "core/parallel.h"
#include "geometry/bvh.h"
#include "geometry/pseudo_normals.h"
#include "geometry/winding_number.h"

namespace glint {

namespace {

// Disjoint sets whose root is always the lowest member.
class UnionFind {
 public:
  explicit UnionFind(size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0u); }
  uint32_t Root(uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void Join(uint32_t a, uint32_t b) {
    a = Root(a), b = Root(b);
    if (a != b) parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<uint32_t> parent_;
};

}  // namespace

Components FindComponents(const TriangleMesh& mesh, const EdgeTopology& topology) {
  const size_t num_faces = mesh.faces.size();
  UnionFind sets(num_faces);
  for (size_t e = 0; e < topology.num_edges(); ++e) {
    const auto corners = topology.CornersOf(e);
    for (uint32_t c : corners) sets.Join(corners[0] / 3, c / 3);
  }
  Components out;
  out.of_face.resize(num_faces);
  std::vector<double> largest_area;
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  if (num_faces > 0) origin = BoundingBox(mesh).center();
  for (uint32_t f = 0; f < num_faces; ++f) {
    const uint32_t root = sets.Root(f);
    if (root == f) {
      out.of_face[f] = static_cast<uint32_t>(out.list.size());
      out.list.push_back({.first_face = f, .largest_face = f});
      largest_area.push_back(-1);
    }
    const uint32_t component = out.of_face[f] = out.of_face[root];
    Component& c = out.list[component];
    const Eigen::Vector3i& v = mesh.faces[f];
    const Eigen::Vector3d& a = mesh.vertices[v[0]];
    const Eigen::Vector3d area = (mesh.vertices[v[1]] - a).cross(mesh.vertices[v[2]] - a) / 2;
    ++c.num_faces;
    c.volume += area.dot(a - origin) / 3;
    if (area.norm() > largest_area[component]) largest_area[component] = area.norm(), c.largest_face = f;
  }
  for (size_t e = 0; e < topology.num_edges(); ++e) {
    const auto corners = topology.CornersOf(e);
    if (corners.size() == 1) out.list[out.of_face[corners[0] / 3]].closed = false;
  }
  return out;
}

void FindWindings(const TriangleMesh& mesh, Components& components) {
  const Bvh bvh(mesh);
  const WindingNumber winding(mesh, bvh);
  ParallelFor(components.list.size(), 1, [&](size_t i) {
    Component& c = components.list[i];
    const Eigen::Vector3i& v = mesh.faces[c.largest_face];
    const Eigen::Vector3d &p = mesh.vertices[v[0]], &q = mesh.vertices[v[1]], &r = mesh.vertices[v[2]];
    const Eigen::Vector3d step = 1e-5 * std::sqrt((q - p).cross(r - p).norm()) * AccurateNormal(p, q, r);
    const Eigen::Vector3d center = (p + q + r) / 3;
    c.winding_front = static_cast<int>(std::lround(winding(center + step)));
    c.winding_back = static_cast<int>(std::lround(winding(center - step)));
  });
}

size_t CountFans(const TriangleMesh& mesh, const EdgeTopology& topology, std::vector<uint32_t>* split) {
  // One set a fan: corners of faces at the same vertex, joined across the edges that meet there.
  UnionFind sets(3 * mesh.faces.size());
  const auto corner_at = [&](uint32_t face, int vertex) {
    const Eigen::Vector3i& v = mesh.faces[face];
    return 3 * face + (v[0] == vertex ? 0u : v[1] == vertex ? 1u : 2u);
  };
  for (size_t e = 0; e < topology.num_edges(); ++e) {
    const auto corners = topology.CornersOf(e);
    const uint32_t first = corners[0] / 3;
    const int ends[2] = {mesh.faces[first][corners[0] % 3], mesh.faces[first][(corners[0] % 3 + 1) % 3]};
    for (uint32_t c : corners)
      for (int end : ends) sets.Join(corner_at(first, end), corner_at(c / 3, end));
  }
  size_t fans = 0;
  std::vector<uint8_t> fans_of(mesh.vertices.size(), 0);
  for (uint32_t c = 0; c < 3 * mesh.faces.size(); ++c) {
    if (sets.Root(c) != c) continue;
    ++fans;
    uint8_t& count = fans_of[mesh.faces[c / 3][c % 3]];
    count = static_cast<uint8_t>(std::min(count + 1, 2));
  }
  if (split)
    for (uint32_t v = 0; v < mesh.vertices.size(); ++v)
      if (fans_of[v] > 1) split->push_back(v);
  return fans;
}

}  // namespace glint
