// How fast the winding number of a mesh may change, away from its faces.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "geometry/bvh.h"
#include "geometry/triangle_mesh.h"

namespace glint::internal {

// Off the surface the gradient of the winding number is that of the boundary alone (the law of Biot and Savart):
// ‖∇w(p)‖ ≤ 1/4π ∑ mₑ |e| / dist(p, e)² over the edges that are run along mₑ times more often one way than the other.
class BoundaryField {
 public:
  explicit BoundaryField(const TriangleMesh& mesh);

  // A bound on ‖∇w‖ anywhere within `radius` of `center`; infinite if the boundary comes that close.
  double GradientBound(const Eigen::Vector3d& center, double radius) const;

  bool empty() const { return edges_.faces.empty(); }

 private:
  TriangleMesh edges_;           // degenerate faces (a, b, b)
  std::vector<double> weights_;  // length times multiplicity of each
  std::unique_ptr<Bvh> bvh_;
  std::vector<double> node_weights_;
};

}  // namespace glint::internal
