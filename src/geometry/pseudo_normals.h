// Normals of all features of a mesh, in linear time [BA05, equations 12.3 to 12.5]: faces n, edges the sum of the
// normals of their faces, vertices Σ αᵢ nᵢ with the incident angles αᵢ. For p off a closed, consistently oriented mesh
// without self-intersections, and c its closest point on the feature with normal N, sign((p − c)·N) tells outside (+)
// from inside (−) exactly. N need not be of unit length.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "geometry/closest_point.h"
#include "geometry/edge_topology.h"
#include "geometry/triangle_mesh.h"

namespace glint {

struct PseudoNormals {
  std::vector<Eigen::Vector3d> face;                 // unit; zero where the face has no area
  std::vector<std::array<Eigen::Vector3d, 3>> edge;  // of corner k: the edge from vertex k to k + 1
  std::vector<Eigen::Vector3d> vertex;

  // The normal of the feature that `at` lies on.
  const Eigen::Vector3d& Of(const TriangleMesh& mesh, const MeshPoint& at) const {
    if (at.feature == Feature::kFace) return face[at.face];
    if (at.feature == Feature::kEdge) return edge[at.face][at.corner];
    return vertex[mesh.faces[at.face][at.corner]];
  }
};

// Exact but for rounding, thin triangles included: their normals are worked out in higher precision.
PseudoNormals ComputePseudoNormals(const TriangleMesh& mesh, const EdgeTopology& topology);

// Unit normal of the triangle abc, to full double precision however thin it is; zero if it has exactly no area.
Eigen::Vector3d AccurateNormal(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c);

// The angle at a of the triangle abc, in [0, π], to full precision also where it is small or nearly π.
double CornerAngle(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c);

}  // namespace glint
