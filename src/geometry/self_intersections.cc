#include "geometry/self_intersections.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/intersections.h>
#include <tbb/concurrent_vector.h>

#include <algorithm>

#include "core/parallel.h"
#include "geometry/bvh.h"

namespace glint {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Triangle = Kernel::Triangle_3;
using Segment = Kernel::Segment_3;

Point ToCgal(const Eigen::Vector3d& x) { return {x[0], x[1], x[2]}; }

Triangle FaceOf(const TriangleMesh& mesh, uint32_t f) {
  const Eigen::Vector3i& v = mesh.faces[f];
  return {ToCgal(mesh.vertices[v[0]]), ToCgal(mesh.vertices[v[1]]), ToCgal(mesh.vertices[v[2]])};
}

bool PassThrough(const TriangleMesh& mesh, uint32_t f, uint32_t g) {
  const Eigen::Vector3i &a = mesh.faces[f], &b = mesh.faces[g];
  int shared = 0, at_f = 0, at_g = 0;  // the last shared corner of each
  bool shared_f[3] = {}, shared_g[3] = {};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (a[i] == b[j]) ++shared, at_f = i, at_g = j, shared_f[i] = true, shared_g[j] = true;
  if (shared > 2) return false;
  const Triangle s = FaceOf(mesh, f), t = FaceOf(mesh, g);
  if (s.is_degenerate() || t.is_degenerate()) return false;
  if (shared == 0) return CGAL::do_intersect(s, t);
  if (shared == 1)  // beyond the shared vertex, an opposite edge must cross the other face
    return CGAL::do_intersect(Segment(s[(at_f + 1) % 3], s[(at_f + 2) % 3]), t) ||
           CGAL::do_intersect(Segment(t[(at_g + 1) % 3], t[(at_g + 2) % 3]), s);
  // Beyond a shared edge, they must be folded onto each other in one plane.
  const int apex_f = !shared_f[0] ? 0 : !shared_f[1] ? 1 : 2, apex_g = !shared_g[0] ? 0 : !shared_g[1] ? 1 : 2;
  const Point &p = s[(apex_f + 1) % 3], &q = s[(apex_f + 2) % 3];
  return CGAL::orientation(p, q, s[apex_f], t[apex_g]) == CGAL::COPLANAR &&
         CGAL::coplanar_orientation(p, q, s[apex_f], t[apex_g]) == CGAL::POSITIVE;
}

struct NodePair {
  uint32_t a, b;
};

// Pairs of subtrees whose boxes overlap, split until there are enough for all threads.
std::vector<NodePair> SplitPairs(const std::vector<Bvh::Node>& nodes, size_t enough) {
  std::vector<NodePair> pairs = {{0, 0}}, next;
  for (bool split = true; split && pairs.size() < enough;) {
    split = false;
    next.clear();
    for (const NodePair& pair : pairs) {
      const Bvh::Node &a = nodes[pair.a], &b = nodes[pair.b];
      if (!a.Overlaps(b)) continue;
      if (pair.a == pair.b && a.count == 0) {
        next.insert(next.end(), {{pair.a + 1, pair.a + 1}, {pair.a + 1, a.right}, {a.right, a.right}});
      } else if (pair.a != pair.b && a.count == 0) {
        next.insert(next.end(), {{pair.a + 1, pair.b}, {a.right, pair.b}});
      } else if (pair.a != pair.b && b.count == 0) {
        next.insert(next.end(), {{pair.a, pair.b + 1}, {pair.a, b.right}});
      } else {
        next.push_back(pair);
        continue;
      }
      split = true;
    }
    pairs.swap(next);
  }
  return pairs;
}

template <class Report>
void Traverse(const TriangleMesh& mesh, const Bvh& bvh, NodePair pair, const Report& report) {
  const Bvh::Node &a = bvh.nodes()[pair.a], &b = bvh.nodes()[pair.b];
  if (!a.Overlaps(b)) return;
  if (a.count > 0 && b.count > 0) {
    for (uint32_t i = a.first; i < a.first + a.count; ++i)
      for (uint32_t j = pair.a == pair.b ? i + 1 : b.first; j < b.first + b.count; ++j) {
        const auto [f, g] = std::minmax(bvh.faces()[i], bvh.faces()[j]);
        if (PassThrough(mesh, f, g)) report(f, g);
      }
  } else if (pair.a == pair.b) {
    Traverse(mesh, bvh, {pair.a + 1, pair.a + 1}, report);
    Traverse(mesh, bvh, {pair.a + 1, a.right}, report);
    Traverse(mesh, bvh, {a.right, a.right}, report);
  } else if (b.count > 0 || (a.count == 0 && (a.max - a.min).squaredNorm() > (b.max - b.min).squaredNorm())) {
    Traverse(mesh, bvh, {pair.a + 1, pair.b}, report);
    Traverse(mesh, bvh, {a.right, pair.b}, report);
  } else {
    Traverse(mesh, bvh, {pair.a, pair.b + 1}, report);
    Traverse(mesh, bvh, {pair.a, b.right}, report);
  }
}

}  // namespace

std::vector<std::array<uint32_t, 2>> SelfIntersections(const TriangleMesh& mesh, size_t limit) {
  const Bvh bvh(mesh);
  if (bvh.empty()) return {};
  const std::vector<NodePair> pairs = SplitPairs(bvh.nodes(), 4096);
  tbb::concurrent_vector<std::array<uint32_t, 2>> found;
  ParallelFor(pairs.size(), 1, [&](size_t i) {
    Traverse(mesh, bvh, pairs[i], [&](uint32_t f, uint32_t g) { found.push_back({f, g}); });
  });
  std::vector<std::array<uint32_t, 2>> sorted(found.begin(), found.end());
  std::sort(sorted.begin(), sorted.end());
  if (sorted.size() > limit) sorted.resize(limit);
  return sorted;
}

}  // namespace glint
