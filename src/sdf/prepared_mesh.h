// A mesh brought into index space and made ready for signing.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <string>
#include <vector>

#include "geometry/closest_point.h"
#include "geometry/triangle_mesh.h"

namespace glint::internal {

struct PreparedMesh {
  TriangleMesh mesh;                  // welded, without collapsed faces, oriented outward if that can be told
  std::vector<uint32_t> source_face;  // of each face: the face it comes from
  size_t collapsed_faces = 0;
  bool balanced = false;  // closed and consistently oriented
  bool turned = false;    // it was inside out
};

// Throws InputError for meshes that cannot be used (geometry/clean_mesh.h). Meshes that are inside out are turned, if
// they may be.
PreparedMesh PrepareMesh(const TriangleMesh& mesh, const Eigen::Affine3d& index_from_world, bool may_turn = true);

// The corner of a feature, and the weights of a point, for a face as it was given.
void AsGiven(const PreparedMesh& prepared, Feature feature, int& corner, Eigen::Vector3d& weights);

// The edges that keep `mesh` from being balanced, in words.
std::string DescribeEdges(const TriangleMesh& mesh);

}  // namespace glint::internal
