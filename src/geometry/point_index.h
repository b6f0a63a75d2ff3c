// Nearest neighbours among a fixed set of points: a small k-d tree, the same answer every time.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace glint {

// Queries are thread-safe. Keeps its own copy of the points.
class PointIndex {
 public:
  explicit PointIndex(std::vector<Eigen::Vector3d> points);

  // The `count` nearest points (fewer if there are fewer), nearest first; of equally near ones the lower index first.
  std::vector<int> Nearest(const Eigen::Vector3d& x, int count) const;

 private:
  void Build(int begin, int end);
  struct Candidates;
  void Search(int begin, int end, const Eigen::Vector3d& x, Candidates& best) const;

  std::vector<Eigen::Vector3d> points_;
  std::vector<int> order_;  // the tree: the middle of every range splits it
  std::vector<int> axis_;   // per position in order_
};

}  // namespace glint
