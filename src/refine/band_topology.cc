#include "refine/band_topology.h"

#include <openvdb/openvdb.h>

#include <utility>

#include "core/check.h"
#include "core/parallel.h"

namespace glint {

struct BandTopology::Index {
  openvdb::Int32Tree tree{kNone};
};

BandTopology::BandTopology(std::vector<Eigen::Vector3i> coords)
    : index_(std::make_unique<Index>()), coords_(std::move(coords)), neighbors_(coords_.size()) {
  GLINT_CHECK_LT(coords_.size(), size_t{1} << 30);
  {
    openvdb::tree::ValueAccessor<openvdb::Int32Tree> accessor(index_->tree);
    for (size_t i = 0; i < coords_.size(); ++i)
      accessor.setValue(openvdb::Coord(coords_[i][0], coords_[i][1], coords_[i][2]), static_cast<int32_t>(i));
  }
  const openvdb::Int32Tree& tree = index_->tree;
  ParallelChunks(coords_.size(), 1 << 14, [&](size_t begin, size_t end) {
    openvdb::tree::ValueAccessor<const openvdb::Int32Tree> accessor(tree);
    for (size_t i = begin; i < end; ++i)
      for (int axis = 0; axis < 3; ++axis)
        for (int side = 0; side < 2; ++side) {
          openvdb::Coord c(coords_[i][0], coords_[i][1], coords_[i][2]);
          c[axis] += side ? 1 : -1;
          neighbors_[i][2 * axis + side] = accessor.getValue(c);
        }
  });
}

BandTopology::~BandTopology() = default;
BandTopology::BandTopology(BandTopology&&) noexcept = default;

int32_t BandTopology::Find(const Eigen::Vector3i& ijk) const {
  return index_->tree.getValue(openvdb::Coord(ijk[0], ijk[1], ijk[2]));
}

}  // namespace glint
