#include "geometry/bvh.h"

#include <tbb/parallel_invoke.h>

#include <algorithm>

#include "core/cancel_scope.h"
#include "core/parallel.h"

namespace glint {

namespace {

// Number of nodes over n faces: the layout is known before the tree is built, so that subtrees build in parallel.
uint32_t NumNodes(uint32_t n) {
  if (n <= static_cast<uint32_t>(Bvh::kLeafSize)) return 1;
  return 1 + NumNodes(n / 2) + NumNodes(n - n / 2);
}

}  // namespace

struct Bvh::Builder {
  const TriangleMesh& mesh;
  std::vector<Node>& nodes;
  std::vector<uint32_t>& faces;
  std::vector<Eigen::Vector3d> centers;
  const Progress& asked = CancelScope::Current();

  void Build(uint32_t node_index, uint32_t begin, uint32_t end) {
    Node& node = nodes[node_index];
    const uint32_t count = end - begin;
    if (count <= static_cast<uint32_t>(kLeafSize)) {
      node.first = begin;
      node.count = count;
      node.min.setConstant(std::numeric_limits<double>::infinity());
      node.max.setConstant(-std::numeric_limits<double>::infinity());
      for (uint32_t i = begin; i < end; ++i)
        for (int k = 0; k < 3; ++k) {
          const Eigen::Vector3d& v = mesh.vertices[mesh.faces[faces[i]][k]];
          node.min = node.min.cwiseMin(v);
          node.max = node.max.cwiseMax(v);
        }
      return;
    }
    Eigen::AlignedBox3d box;
    for (uint32_t i = begin; i < end; ++i) box.extend(centers[faces[i]]);
    int axis;
    box.sizes().maxCoeff(&axis);
    const uint32_t half = count / 2;
    std::nth_element(faces.begin() + begin, faces.begin() + begin + half, faces.begin() + end,
                     [&](uint32_t f, uint32_t g) {
                       const double x = centers[f][axis], y = centers[g][axis];
                       return x != y ? x < y : f < g;
                     });
    const uint32_t left = node_index + 1;
    node.right = left + NumNodes(half);
    if (count > 4096) {
      asked.ThrowIfCancelled();
      tbb::parallel_invoke([&] { Build(left, begin, begin + half); }, [&] { Build(node.right, begin + half, end); });
    } else {
      Build(left, begin, begin + half);
      Build(node.right, begin + half, end);
    }
    node.min = nodes[left].min.cwiseMin(nodes[node.right].min);
    node.max = nodes[left].max.cwiseMax(nodes[node.right].max);
  }
};

Bvh::Bvh(const TriangleMesh& mesh) {
  const size_t num_faces = mesh.faces.size();
  if (num_faces == 0) return;
  faces_.resize(num_faces);
  nodes_.resize(NumNodes(static_cast<uint32_t>(num_faces)));
  Builder builder{mesh, nodes_, faces_, std::vector<Eigen::Vector3d>(num_faces)};
  ParallelFor(num_faces, 4096, [&](size_t f) {
    const Eigen::Vector3i& face = mesh.faces[f];
    faces_[f] = static_cast<uint32_t>(f);
    builder.centers[f] = (mesh.vertices[face[0]] + mesh.vertices[face[1]] + mesh.vertices[face[2]]) / 3;
  });
  builder.Build(0, 0, static_cast<uint32_t>(num_faces));
}

}  // namespace glint
