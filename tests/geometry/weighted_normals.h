// Pseudo-normals as others weight them, to show what goes wrong.
#pragma once

#include <vector>

#include "geometry/closest_point.h"
#include "geometry/pseudo_normals.h"

namespace glint::testing {

enum class Weighting { kFace, kMean, kArea, kAngle };

inline const char* NameOf(Weighting w) {
  return w == Weighting::kFace   ? "face normal"
         : w == Weighting::kMean ? "mean normal"
         : w == Weighting::kArea ? "area-weighted"
                                 : "angle-weighted";
}

// Signs with vertex normals of one weighting; edges have the sum of their faces' normals, but for kFace, which takes
// the normal of whichever face was found. Keeps a reference.
class WeightedSign {
 public:
  WeightedSign(const TriangleMesh& mesh, Weighting weighting)
      : mesh_(mesh),
        weighting_(weighting),
        normals_(ComputePseudoNormals(mesh, BuildEdgeTopology(mesh))),
        vertex_(mesh.vertices.size(), Eigen::Vector3d::Zero()) {
    for (size_t f = 0; f < mesh.faces.size(); ++f)
      for (int k = 0; k < 3; ++k) {
        const Eigen::Vector3d &a = mesh.vertices[mesh.faces[f][k]], &b = mesh.vertices[mesh.faces[f][(k + 1) % 3]],
                              &c = mesh.vertices[mesh.faces[f][(k + 2) % 3]];
        const double weight = weighting == Weighting::kMean   ? 1
                              : weighting == Weighting::kArea ? (b - a).cross(c - a).norm()
                                                              : CornerAngle(a, b, c);
        vertex_[mesh.faces[f][k]] += weight * normals_.face[f];
      }
  }

  bool Inside(const Eigen::Vector3d& p, const MeshPoint& at) const {
    const Eigen::Vector3d r = p - at.point;
    if (weighting_ == Weighting::kFace) return r.dot(normals_.face[at.face]) < 0;
    if (at.feature == Feature::kVertex) return r.dot(vertex_[mesh_.faces[at.face][at.corner]]) < 0;
    return r.dot(normals_.Of(mesh_, at)) < 0;
  }

 private:
  const TriangleMesh& mesh_;
  Weighting weighting_;
  PseudoNormals normals_;
  std::vector<Eigen::Vector3d> vertex_;
};

// A tetrahedron with its sharp tip at the origin, pointing up. Of the three sides at the tip the one that looks to −x
// is cut into `slivers` triangles, and is `length` times as long as the other side's third edge.
inline TriangleMesh Needle(int slivers, double length) {
  const Eigen::Vector3d p = length * Eigen::Vector3d(-0.15, 0.25, -1), q = length * Eigen::Vector3d(-0.15, -0.25, -1),
                        s(0.3, 0, -1);
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, s};
  for (int i = 0; i <= slivers; ++i) mesh.vertices.push_back(p + (q - p) * (static_cast<double>(i) / slivers));
  const int last = 2 + slivers;
  for (int i = 2; i < last; ++i) {
    mesh.faces.emplace_back(0, i, i + 1);
    mesh.faces.emplace_back(1, i + 1, i);
  }
  mesh.faces.emplace_back(0, 1, 2);
  mesh.faces.emplace_back(0, last, 1);
  return mesh;
}

}  // namespace glint::testing
