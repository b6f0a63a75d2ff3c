// Where the object stands on the ground.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "geometry/triangle_mesh.h"
#include "refine/oriented_tree.h"

namespace glint {

// Queries are thread-safe.
class FootPlaces {
 public:
  // `seed` has vertex normals; `foot`, a vertex: above 0 on the foot (kFootScalar), or empty.
  FootPlaces(const TriangleMesh& seed, const std::vector<float>& foot);
  // Whether the place of the seed next to x, of those that face as it does, is on the foot.
  bool At(const Eigen::Vector3d& x, const Eigen::Vector3d& normal) const;

 private:
  struct Places {
    std::vector<Eigen::Vector3d> positions, normals;
    std::vector<uint8_t> on_foot;
  };
  static Places All(const TriangleMesh& seed, const std::vector<float>& foot);

  const Places places_;  // none where there is no foot
  const OrientedTree tree_;
};

}  // namespace glint
