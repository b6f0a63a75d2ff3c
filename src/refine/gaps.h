// How far the surface goes on between the places where it is known.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "refine/bundle.h"
#include "refine/oriented_tree.h"
#include "refine/surface_constraints.h"

namespace glint {

// Queries are thread-safe. Lengths in units of the object's diagonal.
class Gaps {
 public:
  // Points without a normal count for nothing: they are far from the surface.
  Gaps(const std::vector<SurfacePoint>& points, const std::vector<OrientedPoint>& contacts,
       const std::vector<OrientedPoint>& outline);
  // From x, where the surface faces along `normal`, to the next known place that faces as it does, up to 20 degrees;
  // from there to 60, places are as if farther away. Not more than `at_most`.
  double At(const Eigen::Vector3d& x, const Eigen::Vector3d& normal, double at_most) const;

 private:
  struct Places {
    std::vector<Eigen::Vector3d> positions, normals;
  };
  static Places All(const std::vector<SurfacePoint>& points, const std::vector<OrientedPoint>& contacts,
                    const std::vector<OrientedPoint>& outline);

  const Places places_;
  const OrientedTree tree_;
};

}  // namespace glint
