// Closest point of a mesh with its barycentric weights, as the comparisons need it.
#pragma once

#include <Eigen/Core>
#include <memory>

#include "geometry/triangle_mesh.h"

namespace glint {

struct NearestOnMesh {
  Eigen::Vector3d position;
  Eigen::Vector3d weights;  // barycentric, of the face's three vertices
  int face;
  double distance;  // world units
};

// Queries are thread-safe. The mesh must have at least one face and must outlive the finder.
class NearestFinder {
 public:
  explicit NearestFinder(const TriangleMesh& mesh);
  ~NearestFinder();
  NearestOnMesh Find(const Eigen::Vector3d& x) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace glint
