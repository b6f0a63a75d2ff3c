// Exact signed distance on every voxel of a box.
#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "geometry/triangle_mesh.h"
#include "sdf/mesh_to_level_set.h"

namespace glint {

struct DenseField {
  Eigen::Vector3i size = Eigen::Vector3i::Zero();  // voxels along x, y, z
  std::vector<float> values;                       // world units, negative inside; z runs fastest

  float operator()(int x, int y, int z) const {
    return values[(static_cast<size_t>(x) * static_cast<size_t>(size[1]) + static_cast<size_t>(y)) *
                      static_cast<size_t>(size[2]) +
                  static_cast<size_t>(z)];
  }
};

// Distances of the voxels (0, 0, 0) … size − 1, whose centres lie at world_from_index * (x, y, z): exact to float
// rounding however far they are, signed as SdfOptions::sign says. Deterministic. Throws InputError for bad meshes,
// transforms that are no similarity, sizes that are not positive, and grids that do not fit in memory.
DenseField DenseSignedDistance(const TriangleMesh& mesh, const Eigen::Affine3d& world_from_index,
                               const Eigen::Vector3i& size, const std::string& sign = "auto",
                               SdfSummary* summary = nullptr);

}  // namespace glint
