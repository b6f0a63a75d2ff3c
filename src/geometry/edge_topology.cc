#include "geometry/edge_topology.h"

#include <algorithm>
#include <atomic>
#include <numeric>

#include "core/check.h"
#include "core/parallel.h"

namespace glint {

namespace {

// Corners by the lower vertex of their edge.
struct CornersByVertex {
  std::vector<uint32_t> first;
  std::vector<uint32_t> corners;
};

int Lower(const TriangleMesh& mesh, uint32_t corner) {
  const Eigen::Vector3i& face = mesh.faces[corner / 3];
  return std::min(face[corner % 3], face[(corner % 3 + 1) % 3]);
}

int Higher(const TriangleMesh& mesh, uint32_t corner) {
  const Eigen::Vector3i& face = mesh.faces[corner / 3];
  return std::max(face[corner % 3], face[(corner % 3 + 1) % 3]);
}

// In any order within a vertex.
CornersByVertex SortByLowerVertex(const TriangleMesh& mesh) {
  const size_t num_corners = 3 * mesh.faces.size(), num_vertices = mesh.vertices.size();
  CornersByVertex out;
  std::vector<uint32_t> next(num_vertices + 1, 0);
  const auto take = [&](size_t c) {
    return std::atomic_ref<uint32_t>(next[Lower(mesh, static_cast<uint32_t>(c))])
        .fetch_add(1, std::memory_order_relaxed);
  };
  ParallelFor(num_corners, 16384, [&](size_t c) { take(c); });
  out.first.resize(num_vertices + 1);
  std::exclusive_scan(next.begin(), next.end(), out.first.begin(), 0u);
  std::copy(out.first.begin(), out.first.end(), next.begin());
  out.corners.resize(num_corners);
  ParallelFor(num_corners, 16384, [&](size_t c) { out.corners[take(c)] = static_cast<uint32_t>(c); });
  return out;
}

}  // namespace

EdgeTopology BuildEdgeTopology(const TriangleMesh& mesh) {
  const size_t num_vertices = mesh.vertices.size();
  GLINT_CHECK_LT(mesh.faces.size(), size_t{1} << 30);
  CornersByVertex by_vertex = SortByLowerVertex(mesh);
  std::vector<uint32_t>& corners = by_vertex.corners;
  // Within a vertex by the other end, then by corner; count the edges that start there.
  std::vector<uint32_t> first_edge(num_vertices + 1, 0);
  ParallelFor(num_vertices, 4096, [&](size_t v) {
    const auto begin = corners.begin() + by_vertex.first[v], end = corners.begin() + by_vertex.first[v + 1];
    std::sort(begin, end, [&](uint32_t a, uint32_t b) {
      const int x = Higher(mesh, a), y = Higher(mesh, b);
      return x != y ? x < y : a < b;
    });
    uint32_t count = 0;
    for (auto c = begin; c != end; ++c)
      if (c == begin || Higher(mesh, *c) != Higher(mesh, *(c - 1))) ++count;
    first_edge[v + 1] = count;
  });
  for (size_t v = 0; v < num_vertices; ++v) first_edge[v + 1] += first_edge[v];
  EdgeTopology out;
  out.first.resize(first_edge[num_vertices] + 1);
  out.edge_of_corner.resize(corners.size());
  ParallelFor(num_vertices, 4096, [&](size_t v) {
    uint32_t edge = first_edge[v];
    for (uint32_t i = by_vertex.first[v]; i < by_vertex.first[v + 1]; ++i) {
      const bool starts = i == by_vertex.first[v] || Higher(mesh, corners[i]) != Higher(mesh, corners[i - 1]);
      if (starts) out.first[edge++] = i;
      out.edge_of_corner[corners[i]] = edge - 1;
    }
  });
  out.first.back() = static_cast<uint32_t>(corners.size());
  out.corners = std::move(corners);
  return out;
}

bool EdgesBalanced(const TriangleMesh& mesh) {
  const auto mix = [](uint64_t x) {  // the finaliser of MurmurHash3
    x = (x ^ x >> 33) * 0xff51afd7ed558ccdull;
    x = (x ^ x >> 33) * 0xc4ceb9fe1a85ec53ull;
    return x ^ x >> 33;
  };
  const uint64_t sum = ParallelSum(mesh.faces.size(), 16384, uint64_t{0}, [&](size_t begin, size_t end) {
    uint64_t part = 0;
    for (size_t f = begin; f < end; ++f)
      for (int k = 0; k < 3; ++k) {
        const uint32_t a = static_cast<uint32_t>(mesh.faces[f][k]),
                       b = static_cast<uint32_t>(mesh.faces[f][(k + 1) % 3]);
        if (a == b) continue;
        const uint64_t hash = mix(uint64_t{std::min(a, b)} << 32 | std::max(a, b));
        part += a < b ? hash : 0 - hash;
      }
    return part;
  });
  return sum == 0;
}

EdgeCounts CountEdges(const TriangleMesh& mesh, const EdgeTopology& topology) {
  EdgeCounts counts;
  counts.edges = topology.num_edges();
  for (size_t e = 0; e < topology.num_edges(); ++e) {
    const auto corners = topology.CornersOf(e);
    if (corners.size() == 1) ++counts.boundary;
    if (corners.size() > 2) ++counts.non_manifold;
    if (corners.size() != 2) continue;
    const auto start = [&](uint32_t c) { return mesh.faces[c / 3][c % 3]; };
    if (start(corners[0]) == start(corners[1])) ++counts.misoriented;
  }
  return counts;
}

}  // namespace glint
