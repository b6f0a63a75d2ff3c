// Points with normals in a balanced tree of boxes and cones, for searches that know what they can leave out.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <utility>
#include <vector>

namespace glint {

// How far a place of one normal speaks for one of the other, not for what lies around a rim or across a wall: 1 up to
// 20 degrees between them, falling to 0 at 60.
double FacingAlike(const Eigen::Vector3d& a, const Eigen::Vector3d& b);

class OrientedTree {
 public:
  struct Node {
    Eigen::AlignedBox3d box;
    Eigen::Vector3d axis;  // of a cone around all normals
    double spread;         // radians to the cone's side

    // FacingAlike(normal, any of its normals) is 0.
    bool FacesAway(const Eigen::Vector3d& normal) const;
  };

  // Normals of length 1.
  OrientedTree(const std::vector<Eigen::Vector3d>& positions, const std::vector<Eigen::Vector3d>& normals);

  // visit(index) for every point but those below a node of which leave_out(node) is true; it is asked just before its
  // points would be visited. Roughly the nearest to `from` first.
  template <class LeaveOut, class Visit>
  void Walk(const Eigen::Vector3d& from, const LeaveOut& leave_out, const Visit& visit) const {
    if (!order_.empty()) WalkNode({0, 0, order_.size()}, from, leave_out, visit);
  }

 private:
  // The points order_[begin, end) below nodes_[index], whose halves are nodes 2 index + 1 and 2 index + 2.
  struct Range {
    size_t index, begin, end;
    size_t Middle() const { return begin + (end - begin) / 2; }
    std::pair<Range, Range> Halves() const {
      return {{2 * index + 1, begin, Middle()}, {2 * index + 2, Middle(), end}};
    }
  };

  bool IsLeaf(const Range& range) const { return 2 * range.index + 1 >= nodes_.size(); }
  std::vector<Range> Level(int level) const;

  template <class LeaveOut, class Visit>
  void WalkNode(const Range& range, const Eigen::Vector3d& from, const LeaveOut& leave_out, const Visit& visit) const {
    if (leave_out(nodes_[range.index])) return;
    if (IsLeaf(range)) {
      for (size_t k = range.begin; k < range.end; ++k) visit(order_[k]);
      return;
    }
    auto [near, far] = range.Halves();
    if (nodes_[far.index].box.squaredExteriorDistance(from) < nodes_[near.index].box.squaredExteriorDistance(from))
      std::swap(near, far);
    WalkNode(near, from, leave_out, visit);
    WalkNode(far, from, leave_out, visit);
  }

  std::vector<uint32_t> order_;
  std::vector<Node> nodes_;
};

}  // namespace glint
