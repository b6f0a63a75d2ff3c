// Grids of a prepared mesh, by each way of signing. Only for .cc files: it brings OpenVDB along.
#pragma once

#include <openvdb/openvdb.h>

#include <vector>

#include "sdf/band.h"
#include "sdf/mesh_to_level_set.h"
#include "sdf/prepared_mesh.h"
#include "sdf/tile_binning.h"

namespace glint::internal {

// Keeps a reference to `prepared`. The grids have no transform yet; values in world units.
class BandMaker {
 public:
  BandMaker(const PreparedMesh& prepared, double half_width_voxels, double voxel_size);

  // Distances are corrected by at most `reach` voxels once they are known. Kept by reference.
  void SetCorrection(const DistanceCorrection& correction, double reach);

  // Filled anew by each of the functions below.
  void SetClosest(std::vector<VoxelClosest>& closest) { closest_ = &closest; }

  openvdb::FloatGrid::Ptr Unsigned() const;
  openvdb::FloatGrid::Ptr ByPseudoNormals() const;
  openvdb::FloatGrid::Ptr ByWinding() const;

 private:
  openvdb::FloatGrid::Ptr MakeGrid(const BandOptions& band) const;

  const PreparedMesh& prepared_;
  BandOptions band_;
  TileBins bins_;
  std::vector<VoxelClosest>* closest_ = nullptr;
};

}  // namespace glint::internal
