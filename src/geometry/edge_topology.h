// Which faces meet at which edge. Corner 3 f + k stands for the edge of face f from its vertex k to k + 1 (mod 3).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/triangle_mesh.h"

namespace glint {

struct EdgeTopology {
  std::vector<uint32_t> edge_of_corner;  // 3 F: the undirected edge of each corner
  std::vector<uint32_t> first;           // E + 1: where each edge's corners begin in `corners`
  std::vector<uint32_t> corners;         // 3 F: ascending within an edge

  size_t num_edges() const { return first.empty() ? 0 : first.size() - 1; }
  std::span<const uint32_t> CornersOf(size_t edge) const {
    return {corners.data() + first[edge], corners.data() + first[edge + 1]};
  }
};

// Edges are numbered by their lower, then their higher vertex.
EdgeTopology BuildEdgeTopology(const TriangleMesh& mesh);

// True if every edge is run along as often one way as the other: the faces, oriented as they are, bound something.
// Holds for closed, consistently oriented meshes, non-manifold edges included. Linear time, without a topology: sums of
// hashes of directed edges cancel (a false yes has odds of about 2⁻⁶⁴).
bool EdgesBalanced(const TriangleMesh& mesh);

// What the edges tell of the surface as a whole.
struct EdgeCounts {
  size_t edges = 0;
  size_t boundary = 0;      // one face
  size_t non_manifold = 0;  // three faces or more
  size_t misoriented = 0;   // two faces that run along it the same way
  bool closed_and_oriented() const { return boundary == 0 && non_manifold == 0 && misoriented == 0; }
};
EdgeCounts CountEdges(const TriangleMesh& mesh, const EdgeTopology& topology);

}  // namespace glint
