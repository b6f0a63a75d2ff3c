// Smooth samples of a grid. Only for .cc files: it brings OpenVDB along.
#pragma once

#include <openvdb/openvdb.h>

namespace glint::internal {

struct FieldSample {
  double value;
  openvdb::Vec3d gradient;  // by index coordinates
};

// The zero set of trilinear samples of a distance field lies inside of round surfaces, by about 1/(6 R) voxels for a
// radius of R voxels. Tricubic samples (Catmull and Rom 1974) reproduce quadratic functions, and are off by an order
// less. Where some of the 4³ voxels are inactive, trilinear samples and their central differences are given. One
// sampler a thread; keeps a reference.
class FieldSampler {
 public:
  explicit FieldSampler(const openvdb::FloatTree& tree) : accessor_(tree) {}

  FieldSample operator()(const openvdb::Vec3d& x_in_index);

 private:
  using Leaf = openvdb::FloatTree::LeafNodeType;

  FieldSample Trilinear(const openvdb::Vec3d& x_in_index) const;
  bool LoadStencil(const openvdb::Coord& first);

  openvdb::tree::ValueAccessor<const openvdb::FloatTree, false> accessor_;
  float stencil_[4][4][4];
};

}  // namespace glint::internal
