#include "sdf/band_maker.h"

#include <openvdb/tools/SignedFloodFill.h>

#include <algorithm>
#include <utility>

#include "core/parallel.h"
#include "sdf/exact_side.h"
#include "sdf/winding_signs.h"

namespace glint::internal {

namespace {

// Pseudo-normals have told the sides of the active voxels; the others follow.
class SpreadSigner : public LeafSigner {
 public:
  LeafBits Inside(const Eigen::Vector3i&, const TileDistances& distances) const override {
    LeafBits known, inside;
    std::copy_n(distances.active, 8, known.begin());
    std::copy_n(distances.inside, 8, inside.begin());
    return SpreadSides(known, inside);
  }
};

// Tiles take the sides of the leaves beside them.
void FillTiles(openvdb::FloatGrid& grid) {
  openvdb::tools::signedFloodFillWithValues(grid.tree(), grid.background(), -grid.background(), true, 1, 1);
}

// The features of the active voxels of all leaves, whose closest triangles are known.
std::vector<VoxelClosest> FindFeatures(const PreparedMesh& prepared, const std::vector<std::unique_ptr<Leaf>>& leaves,
                                       const std::vector<std::vector<uint32_t>>& triangles) {
  std::vector<size_t> first(leaves.size() + 1, 0);
  for (size_t i = 0; i < leaves.size(); ++i) first[i + 1] = first[i] + (leaves[i] ? triangles[i].size() : 0);
  std::vector<VoxelClosest> out(first.back());
  ParallelFor(leaves.size(), 16, [&](size_t i) {
    if (!leaves[i]) return;
    VoxelClosest* to = out.data() + first[i];
    const uint32_t* triangle = triangles[i].data();
    for (auto it = leaves[i]->cbeginValueOn(); it; ++it, ++triangle) {
      const openvdb::Coord at = it.getCoord();
      const Eigen::Vector3i voxel(at[0], at[1], at[2]), &face = prepared.mesh.faces[*triangle];
      const Eigen::Vector3d &a = prepared.mesh.vertices[face[0]], &b = prepared.mesh.vertices[face[1]],
                            &c = prepared.mesh.vertices[face[2]];
      const TrianglePoint x = ClosestOnTriangle(a, b, c, voxel.cast<double>());
      Eigen::Vector3d weights = Barycentric(a, b, c, x.point);
      int corner = x.corner;
      AsGiven(prepared, x.feature, corner, weights);
      *to++ = {voxel, prepared.source_face[*triangle], x.feature, static_cast<uint8_t>(corner), weights.cast<float>()};
    }
  });
  return out;
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
  const PseudoNormalSide exact(prepared_.mesh);
  const SpreadSigner signer;
  BandOptions band = band_;
  band.exact = &exact;
  band.signer = &signer;
  openvdb::FloatGrid::Ptr grid = MakeGrid(band);
  FillTiles(*grid);
  return grid;
}

openvdb::FloatGrid::Ptr BandMaker::ByWinding() const {
  const WindingSigner signer(prepared_.mesh, prepared_.balanced, band_.half_width_voxels);
  BandOptions band = band_;
  band.signer = &signer;
  openvdb::FloatGrid::Ptr grid = MakeGrid(band);
  if (prepared_.balanced) {
    FillTiles(*grid);
  } else {
    signer.FillTiles(grid->tree());
  }
  return grid;
}

openvdb::FloatGrid::Ptr BandMaker::MakeGrid(const BandOptions& band) const {
  std::vector<std::vector<uint32_t>> triangles;
  std::vector<std::unique_ptr<Leaf>> leaves =
      ComputeLeaves(prepared_.mesh, bins_, band, nullptr, closest_ ? &triangles : nullptr);
  if (closest_) *closest_ = FindFeatures(prepared_, leaves, triangles);
  openvdb::FloatGrid::Ptr grid =
      openvdb::FloatGrid::create(static_cast<float>(band.half_width_voxels * band.voxel_size));
  for (auto& leaf : leaves)
    if (leaf) grid->tree().addLeaf(leaf.release());
  return grid;
}

}  // namespace glint::internal
