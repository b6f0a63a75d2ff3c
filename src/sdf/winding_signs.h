// Signs by generalised winding number (Barill et al. 2018), for meshes that pseudo-normals cannot sign. Only for .cc
// files: it brings OpenVDB along.
#pragma once

#include <openvdb/openvdb.h>

#include "geometry/bvh.h"
#include "geometry/winding_number.h"
#include "sdf/band.h"
#include "sdf/boundary_field.h"

namespace glint::internal {

// Inside is where the winding number exceeds ½. It is constant where no surface is crossed, but for the influence of
// the mesh's boundary, of which a bound is known: so most voxels need no evaluation of their own. Keeps references.
class WindingSigner : public LeafSigner {
 public:
  WindingSigner(const TriangleMesh& mesh_in_index, bool balanced, double half_width_voxels);

  LeafBits Inside(const Eigen::Vector3i& origin, const TileDistances& distances) const override;

  // Gives all inactive tiles of the tree within the mesh's box their sides, and makes leaves where the side changes
  // away from the surface: over holes. Leaves must have their signs already.
  void FillTiles(openvdb::FloatTree& tree) const;

  bool InsideAt(const Eigen::Vector3d& x_in_index) const { return winding_(x_in_index) > 0.5; }

 private:
  enum class Side { kOutside, kInside, kMixed };
  // The side of a cube free of surface, or kMixed if it may change within.
  Side SideOfCube(const Eigen::Vector3d& center, double radius) const;
  LeafBits InsideOfFreeLeaf(const Eigen::Vector3i& origin) const;

  const TriangleMesh* mesh_;
  bool balanced_;
  double half_width_;
  Bvh bvh_;
  WindingNumber winding_;
  BoundaryField boundary_;
};

}  // namespace glint::internal
