// What a signed distance field must say: by brute force, and by exact arithmetic.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "geometry/triangle_mesh.h"

namespace glint::benchmark {

// Distances in double to all triangles, but for those whose bounding sphere is further away than the best so far.
class BruteForce {
 public:
  explicit BruteForce(const TriangleMesh& mesh);
  double Distance(const Eigen::Vector3d& p) const;

 private:
  const TriangleMesh& mesh_;
  std::vector<double> x_, y_, z_, radius_;
};

// Winding numbers by rays along z, in exact arithmetic: the crossings of a ray are counted by the signs of exact
// determinants, and a ray through an edge or a vertex is moved by an infinitesimal amount (Edelsbrunner and Mücke
// 1990). For closed meshes.
class ExactSides {
 public:
  explicit ExactSides(const TriangleMesh& mesh);
  ~ExactSides();

  static constexpr int kOnSurface = 1 << 20;
  // Of the points (x, y, z[i]).
  void Column(double x, double y, const double* z, int count, int* winding) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace glint::benchmark
