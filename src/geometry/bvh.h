// A bounding volume hierarchy over the faces of a mesh. Median splits, built in parallel; the layout depends on the
// mesh alone.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "geometry/triangle_mesh.h"

namespace glint {

class Bvh {
 public:
  static constexpr int kLeafSize = 4;

  // A leaf holds faces()[first .. first + count); an inner node (count = 0) has its left child right behind it and
  // its right child at `right`.
  struct Node {
    Eigen::Vector3d min, max;
    uint32_t first = 0;
    uint32_t count = 0;
    uint32_t right = 0;

    double SquaredDistance(const Eigen::Vector3d& p) const {
      return (min - p).cwiseMax(p - max).cwiseMax(0.0).squaredNorm();
    }
    bool Overlaps(const Node& other) const {
      return (min.array() <= other.max.array()).all() && (other.min.array() <= max.array()).all();
    }
  };

  explicit Bvh(const TriangleMesh& mesh);

  const std::vector<Node>& nodes() const { return nodes_; }
  const std::vector<uint32_t>& faces() const { return faces_; }
  bool empty() const { return faces_.empty(); }

 private:
  struct Builder;
  std::vector<Node> nodes_;
  std::vector<uint32_t> faces_;
};

}  // namespace glint
