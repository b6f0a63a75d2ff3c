// The narrow band of a mesh, leaf by leaf. Only for .cc files: it brings OpenVDB along.
#pragma once

#include <openvdb/openvdb.h>

#include <memory>
#include <vector>

#include "geometry/triangle_mesh.h"
#include "sdf/leaf_signs.h"
#include "sdf/tile_binning.h"
#include "sdf/tile_kernel.h"

namespace glint::internal {

using Leaf = openvdb::FloatTree::LeafNodeType;

// Tells the sides of all voxels of a leaf once its distances are known (active voxels positive or, if the kernel has
// told their sides already, negative inside).
class LeafSigner {
 public:
  virtual ~LeafSigner() = default;
  virtual LeafBits Inside(const Eigen::Vector3i& origin, const TileDistances& distances) const = 0;
};

// Changes distances once they are known, from those to the mesh to those to the surface that it stands for.
class DistanceCorrection {
 public:
  virtual ~DistanceCorrection() = default;
  // For each active voxel: its signed distance in voxels.
  virtual void Correct(const Eigen::Vector3i& origin, TileDistances& distances) const = 0;
};

struct BandOptions {
  double half_width_voxels;
  double voxel_size;
  const ExactSide* exact = nullptr;    // null: distances without signs
  const LeafSigner* signer = nullptr;  // null: everything is outside
  const DistanceCorrection* correction = nullptr;
  double correction_reach = 0;  // voxels by which it may change a distance
};

// One leaf for each tile that has an active voxel, in the order of the tiles; null for the others. Values in world
// units. `closest`, if given, gets the closest triangles of the active voxels of each leaf, in their order.
std::vector<std::unique_ptr<Leaf>> ComputeLeaves(const TriangleMesh& mesh_in_index, const TileBins& bins,
                                                 const BandOptions& options, TileCounters* counters = nullptr,
                                                 std::vector<std::vector<uint32_t>>* closest = nullptr);

}  // namespace glint::internal
