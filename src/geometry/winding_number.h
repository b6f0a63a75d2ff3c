// Generalised winding number of a triangle mesh: 1 inside, 0 outside, in between near holes and overlaps.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "geometry/bvh.h"
#include "geometry/triangle_mesh.h"

namespace glint {

// The sum of the solid angles of all faces over 4π (van Oosterom and Strackee 1983), in double: exact, linear time.
double ExactWindingNumber(const TriangleMesh& mesh, const Eigen::Vector3d& p);

// Barill et al. 2018, "Fast winding numbers for soups and clouds": subtrees further away than `accuracy` times their
// radius are replaced by their expansion to second order. Keeps references to mesh and tree. Thread-safe.
class WindingNumber {
 public:
  explicit WindingNumber(const TriangleMesh& mesh, const Bvh& bvh, double accuracy = 2);
  double operator()(const Eigen::Vector3d& p) const;

 private:
  // Of the faces under a node, δ = x − center, n the unit normal: what the expansion of Σ ∫ n·G(x − p) dA needs,
  // G(r) = r/‖r‖³, after the symmetries of its derivatives are used.
  struct Moments {
    Eigen::Vector3d center;                 // area-weighted
    double radius;                          // of the faces about the centre
    Eigen::Vector3d normal;                 // ∫ n
    Eigen::Matrix3d first;                  // ∫ n δᵀ
    Eigen::Vector3d trace;                  // ½ ∫ n ‖δ‖²
    Eigen::Vector3d contraction;            // ½ ∫ (n·δ) δ
    std::array<Eigen::Matrix3d, 3> second;  // ½ ∫ nᵢ δ δᵀ
  };

  const TriangleMesh* mesh_;
  const Bvh* bvh_;
  double accuracy_;
  std::vector<Moments> moments_;
};

}  // namespace glint
