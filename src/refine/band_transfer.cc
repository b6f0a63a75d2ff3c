#include "refine/band_transfer.h"

#include <openvdb/openvdb.h>

#include <bit>

#include "core/parallel.h"

namespace glint {
namespace {

constexpr size_t kGrain = 1 << 13;

Eigen::Vector3i ParentOf(const Eigen::Vector3i& fine, int bits) {
  Eigen::Vector3i parent;
  for (int axis = 0; axis < 3; ++axis) {
    parent[axis] = fine[axis] >> 1;  // rounds down, also below zero
    if (bits >> axis & 1) parent[axis] += fine[axis] & 1 ? 1 : -1;
  }
  return parent;
}

// All parents, in OpenVDB's leaf order.
std::vector<Eigen::Vector3i> CoarseCoords(const BandTopology& fine) {
  openvdb::MaskTree mask;
  {
    openvdb::tree::ValueAccessor<openvdb::MaskTree> accessor(mask);
    for (size_t i = 0; i < fine.size(); ++i)
      for (int bits = 0; bits < 8; ++bits) {
        const Eigen::Vector3i p = ParentOf(fine.Coord(i), bits);
        accessor.setValueOn(openvdb::Coord(p[0], p[1], p[2]));
      }
  }
  std::vector<Eigen::Vector3i> coords;
  coords.reserve(mask.activeVoxelCount());
  for (auto leaf = mask.cbeginLeaf(); leaf; ++leaf)
    for (auto voxel = leaf->cbeginValueOn(); voxel; ++voxel) {
      const openvdb::Coord c = voxel.getCoord();
      coords.emplace_back(c.x(), c.y(), c.z());
    }
  return coords;
}

}  // namespace

BandTransfer::BandTransfer(const BandTopology& fine) : coarse_(CoarseCoords(fine)), parents_(fine.size()) {
  ParallelFor(fine.size(), kGrain, [&](size_t i) {
    for (int bits = 0; bits < 8; ++bits) parents_[i][bits] = coarse_.Find(ParentOf(fine.Coord(i), bits));
  });
  begin_.assign(coarse_.size() + 1, 0);
  for (const auto& parents : parents_)
    for (int32_t p : parents) ++begin_[p + 1];
  for (size_t c = 0; c < coarse_.size(); ++c) begin_[c + 1] += begin_[c];
  children_.resize(begin_.back());
  std::vector<size_t> next(begin_.begin(), begin_.end() - 1);
  for (size_t i = 0; i < parents_.size(); ++i)
    for (unsigned bits = 0; bits < 8; ++bits)
      children_[next[parents_[i][bits]]++] = static_cast<uint32_t>(i) | static_cast<uint32_t>(std::popcount(bits))
                                                                            << 30;
}

void BandTransfer::AddProlonged(const std::vector<float>& coarse, std::vector<float>& fine) const {
  ParallelFor(fine.size(), kGrain, [&](size_t i) {
    float value = 0;
    for (unsigned bits = 0; bits < 8; ++bits) value += kWeight[std::popcount(bits)] * coarse[parents_[i][bits]];
    fine[i] += value;
  });
}

void BandTransfer::Restrict(const std::vector<float>& fine, std::vector<float>& coarse) const {
  coarse.resize(coarse_.size());
  ParallelFor(coarse_.size(), kGrain / 8, [&](size_t c) {
    float value = 0;
    for (size_t e = begin_[c]; e < begin_[c + 1]; ++e)
      value += kWeight[children_[e] >> 30] * fine[children_[e] & kIndexMask];
    coarse[c] = value;
  });
}

BandRows BandTransfer::Restrict(const BandRows& fine) const {
  BandRows coarse;
  RowBuilder row(coarse_.size());
  for (size_t r = 0; r < fine.size(); ++r) {
    for (size_t e = fine.begin[r]; e < fine.begin[r + 1]; ++e)
      for (unsigned bits = 0; bits < 8; ++bits)
        row.Push(parents_[fine.voxel[e]][bits], kWeight[std::popcount(bits)] * fine.coefficient[e]);
    row.Close(fine.target[r], fine.weight[r], coarse);
  }
  return coarse;
}

std::vector<Eigen::Vector3f> BandTransfer::MeanNormals(const std::vector<Eigen::Vector3f>& fine) const {
  std::vector<Eigen::Vector3f> coarse(coarse_.size());
  ParallelFor(coarse_.size(), kGrain / 8, [&](size_t c) {
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    for (size_t e = begin_[c]; e < begin_[c + 1]; ++e)
      sum += kWeight[children_[e] >> 30] * fine[children_[e] & kIndexMask];
    coarse[c] = sum.norm() > 0 ? Eigen::Vector3f(sum.normalized()) : Eigen::Vector3f::Zero();
  });
  return coarse;
}

}  // namespace glint
