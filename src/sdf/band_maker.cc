#include "sdf/band_maker.h"

#include <openvdb/tools/SignedFloodFill.h>

#include <cmath>

#include "geometry/edge_topology.h"
#include "geometry/pseudo_normals.h"
#include "sdf/exact_side.h"
#include "sdf/winding_signs.h"

namespace glint::internal {

namespace {

// Pseudo-normals have told the sides of the active voxels; the others follow.
class SpreadSigner : public LeafSigner {
 public:
  LeafBits Inside(const Eigen::Vector3i&, const TileDistances& distances) const override {
    LeafBits known, inside{};
    for (int x = 0; x < 8; ++x) {
      known[x] = distances.active[x];
      for (int i = 0; i < 64; ++i) inside[x] |= uint64_t{std::signbit(distances.distance[x << 6 | i])} << i;
    }
    return SpreadSides(known, inside);
  }
};

// Tiles take the sides of the leaves beside them.
void FillTiles(openvdb::FloatGrid& grid) {
  openvdb::tools::signedFloodFillWithValues(grid.tree(), grid.background(), -grid.background(), true, 1, 1);
}

}  // namespace

BandMaker::BandMaker(const PreparedMesh& prepared, double half_width_voxels, double voxel_size)
    : prepared_(prepared),
      band_{half_width_voxels, voxel_size},
      bins_(BinTriangles(prepared.mesh, half_width_voxels)) {}

void BandMaker::SetCorrection(const DistanceCorrection& correction, double reach) {
  band_.correction = &correction;
  band_.correction_reach = reach;
  bins_ = BinTriangles(prepared_.mesh, band_.half_width_voxels + reach);
}

openvdb::FloatGrid::Ptr BandMaker::Unsigned() const { return MakeGrid(band_); }

openvdb::FloatGrid::Ptr BandMaker::ByPseudoNormals() const {
  const PseudoNormals normals = ComputePseudoNormals(prepared_.mesh, BuildEdgeTopology(prepared_.mesh));
  const PseudoNormalSide exact(prepared_.mesh, normals);
  const SpreadSigner signer;
  BandOptions band = band_;
  band.exact = &exact;
  band.signer = &signer;
  const openvdb::FloatGrid::Ptr grid = MakeGrid(band);
  FillTiles(*grid);
  return grid;
}

openvdb::FloatGrid::Ptr BandMaker::ByWinding() const {
  const WindingSigner signer(prepared_.mesh, prepared_.balanced, band_.half_width_voxels);
  BandOptions band = band_;
  band.signer = &signer;
  const openvdb::FloatGrid::Ptr grid = MakeGrid(band);
  if (prepared_.balanced) {
    FillTiles(*grid);
  } else {
    signer.FillTiles(grid->tree());
  }
  return grid;
}

openvdb::FloatGrid::Ptr BandMaker::MakeGrid(const BandOptions& band) const {
  std::vector<std::unique_ptr<Leaf>> leaves = ComputeLeaves(prepared_.mesh, bins_, band);
  openvdb::FloatGrid::Ptr grid =
      openvdb::FloatGrid::create(static_cast<float>(band.half_width_voxels * band.voxel_size));
  for (auto& leaf : leaves)
    if (leaf) grid->tree().addLeaf(leaf.release());
  return grid;
}

}  // namespace glint::internal
