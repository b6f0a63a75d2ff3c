#include "sdf/prepared_mesh.h"

#include <fmt/format.h>

#include "core/error.h"
#include "core/parallel.h"
#include "geometry/clean_mesh.h"
#include "geometry/edge_topology.h"

namespace glint::internal {

PreparedMesh PrepareMesh(const TriangleMesh& mesh, const Eigen::Affine3d& index_from_world, bool may_turn) {
  CleanMesh clean = Clean(mesh);
  if (clean.mesh.faces.empty())
    throw InputError("", "mesh", "expected at least one triangle with three different corners, found none");
  PreparedMesh out{std::move(clean.mesh), std::move(clean.source_face), clean.collapsed_faces};
  TriangleMesh& m = out.mesh;
  ParallelFor(m.vertices.size(), 16384, [&](size_t v) { m.vertices[v] = index_from_world * m.vertices[v]; });
  out.balanced = EdgesBalanced(m);
  if (may_turn && SignedVolume(m) < 0) {
    // An open mesh is turned only if its holes are small; of a sheet nobody can tell.
    bool turn = out.balanced;
    if (!turn) {
      const EdgeCounts counts = CountEdges(m, BuildEdgeTopology(m));
      turn = 10 * (counts.boundary + counts.misoriented) < counts.edges;
    }
    if (turn) {
      for (Eigen::Vector3i& face : m.faces) std::swap(face[1], face[2]);
      out.turned = true;
    }
  }
  return out;
}

void AsGiven(const PreparedMesh& prepared, Feature feature, int& corner, Eigen::Vector3d& weights) {
  if (!prepared.turned) return;  // else corners 1 and 2 have been swapped, and with them edges 0 and 2
  std::swap(weights[1], weights[2]);
  if (feature == Feature::kVertex && corner > 0) corner = 3 - corner;
  if (feature == Feature::kEdge) corner = 2 - corner;
}

std::string DescribeEdges(const TriangleMesh& mesh) {
  const EdgeCounts counts = CountEdges(mesh, BuildEdgeTopology(mesh));
  return fmt::format("{} boundary edges, {} non-manifold, {} whose faces disagree", counts.boundary,
                     counts.non_manifold, counts.misoriented);
}

}  // namespace glint::internal
