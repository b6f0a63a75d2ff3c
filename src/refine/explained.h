// How much of a surface its contacts explain.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "refine/oriented_tree.h"
#include "refine/surface_constraints.h"

namespace glint {

// Near 1 at a contact, for a surface that faces as it does; falls off over the contact's reach and as normals part, to
// 0 at three reaches and at 60 degrees. The largest of all contacts counts. Queries are thread-safe and take the time
// of the contacts nearby. Keeps a reference to the contacts.
class Explained {
 public:
  explicit Explained(const std::vector<OrientedPoint>& contacts);
  // `normal`: unit, or zero where there is none.
  double At(const Eigen::Vector3d& x, const Eigen::Vector3d& normal) const;

 private:
  const std::vector<OrientedPoint>& contacts_;
  OrientedTree tree_;
  double longest_reach_ = 0;
};

}  // namespace glint
