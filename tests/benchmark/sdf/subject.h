// A mesh with what the peers and the checks need of it.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "geometry/clean_mesh.h"
#include "geometry/edge_topology.h"
#include "geometry/pseudo_normals.h"
#include "geometry/triangle_mesh.h"
#include "tests/benchmark/sdf/peers.h"
#include "tests/benchmark/sdf/truth.h"

namespace glint::benchmark {

// Welded and turned outward, as Glint does for itself.
inline TriangleMesh Prepared(const TriangleMesh& given) {
  TriangleMesh mesh = Clean(given).mesh;
  if (EdgesBalanced(mesh) && SignedVolume(mesh) < 0)
    for (Eigen::Vector3i& face : mesh.faces) std::swap(face[1], face[2]);
  return mesh;
}

// Peers keep references into it: it stays where it is.
struct Subject {
  std::string name;
  TriangleMesh given, mesh;
  PseudoNormals normals;
  BruteForce brute;
  std::optional<ExactSides> sides;  // of closed, consistently oriented meshes
  std::vector<std::unique_ptr<PointPeer>> peers;

  Subject(const std::string& mesh_name, TriangleMesh mesh_given)
      : name(mesh_name),
        given(std::move(mesh_given)),
        mesh(Prepared(given)),
        normals(ComputePseudoNormals(mesh, BuildEdgeTopology(mesh))),
        brute(mesh) {
    if (EdgesBalanced(mesh)) sides.emplace(mesh);
  }
  Subject(const Subject&) = delete;
  Subject& operator=(const Subject&) = delete;
};

}  // namespace glint::benchmark
