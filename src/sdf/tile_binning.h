// Which triangles come near which tile of 8³ voxels.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "geometry/triangle_mesh.h"

namespace glint::internal {

// Tiles in no particular but a fixed order; tile i has the triangles first[i] … first[i + 1], ascending.
struct TileBins {
  std::vector<Eigen::Vector3i> origin;  // first voxel, a multiple of 8
  std::vector<size_t> first;
  std::vector<uint32_t> triangles;

  size_t size() const { return origin.size(); }
};

// For each tile that has a voxel closer than `reach` voxels to the mesh, at least all triangles that close to one of
// its voxels; and some tiles and triangles more. Coordinates in voxels. Deterministic.
TileBins BinTriangles(const TriangleMesh& mesh_in_index, double reach);

}  // namespace glint::internal
