#include "sdf/triangulate_quads.h"

namespace glint::internal {

using openvdb::Vec3d;

namespace {

void AddTriangle(std::vector<Eigen::Vector3i>& faces, uint32_t a, uint32_t b, uint32_t c) {
  if (a != b && b != c && c != a) faces.emplace_back(a, b, c);
}

}  // namespace

// Quads are split along their shorter diagonal. OpenVDB winds polygons clockwise seen from outside.
std::vector<Eigen::Vector3i> Triangulate(const std::vector<Vec3d>& x, const std::vector<openvdb::Vec3I>& triangles,
                                         const std::vector<openvdb::Vec4I>& quads) {
  std::vector<Eigen::Vector3i> faces;
  faces.reserve(triangles.size() + 2 * quads.size());
  for (const openvdb::Vec3I& t : triangles) AddTriangle(faces, t[2], t[1], t[0]);
  for (const openvdb::Vec4I& q : quads) {
    if ((x[q[0]] - x[q[2]]).lengthSqr() <= (x[q[1]] - x[q[3]]).lengthSqr()) {
      AddTriangle(faces, q[2], q[1], q[0]);
      AddTriangle(faces, q[3], q[2], q[0]);
    } else {
      AddTriangle(faces, q[3], q[1], q[0]);
      AddTriangle(faces, q[3], q[2], q[1]);
    }
  }
  return faces;
}

}  // namespace glint::internal
