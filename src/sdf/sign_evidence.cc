#include "sdf/sign_evidence.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <vector>

#include "core/parallel.h"

namespace glint::internal {

namespace {

using Leaf = openvdb::FloatTree::LeafNodeType;
using Accessor = openvdb::tree::ValueAccessor<const openvdb::FloatTree, false>;
using openvdb::Coord;

bool Conflict(float a, float b, float limit) {
  return std::signbit(a) != std::signbit(b) && std::abs(a) + std::abs(b) > limit;
}

// Bit i: voxel i of the x-slice has a negative value.
uint64_t NegativeBits(const float* slice) {
  uint8_t signs[64];
  for (int i = 0; i < 64; ++i) signs[i] = static_cast<uint8_t>(std::bit_cast<uint32_t>(slice[i]) >> 31);
  uint64_t bits = 0;
  for (size_t i = 0; i < 8; ++i) {
    uint64_t eight;
    std::memcpy(&eight, signs + 8 * i, 8);
    bits |= (eight * 0x0102040810204080ull >> 56) << (8 * i);  // gathers the lowest bits of eight bytes
  }
  return bits;
}

// Neighbours within the leaf. Only pairs of different signs are looked at.
size_t ConflictsWithin(const float* values, float limit) {
  size_t count = 0;
  const auto check = [&](uint64_t pairs, int first, int stride) {
    for (; pairs != 0; pairs &= pairs - 1) {
      const int i = first + std::countr_zero(pairs);
      count += std::abs(values[i]) + std::abs(values[i + stride]) > limit;
    }
  };
  uint64_t before = 0;
  for (int x = 0; x < 8; ++x) {
    const uint64_t bits = NegativeBits(values + 64 * static_cast<size_t>(x));
    check((bits ^ bits >> 1) & 0x7f7f7f7f7f7f7f7full, 64 * x, 1);
    check((bits ^ bits >> 8) & 0x00ffffffffffffffull, 64 * x, 8);
    if (x > 0) check(bits ^ before, 64 * (x - 1), 64);
    before = bits;
  }
  return count;
}

// With the leaf or the tile on one side of an axis.
size_t ConflictsAcross(Accessor& tree, const Leaf& leaf, int axis, int direction, float limit) {
  Coord beside = leaf.origin();
  beside[axis] += direction * 8;
  const Leaf* other = tree.probeConstLeaf(beside);
  if (other != nullptr && direction < 0) return 0;  // the other one counts
  const int stride = axis == 0 ? 64 : axis == 1 ? 8 : 1;
  const int u = axis == 0 ? 8 : 64, v = axis == 2 ? 8 : 1;
  const float* mine = leaf.buffer().data() + (direction > 0 ? 7 * stride : 0);
  const float* theirs = other ? other->buffer().data() : nullptr;
  const float tile = other ? 0 : tree.getValue(beside);
  size_t count = 0;
  for (int i = 0; i < 8; ++i)
    for (int j = 0; j < 8; ++j) {
      const int at = u * i + v * j;
      count += Conflict(mine[at], theirs ? theirs[at] : tile, limit);
    }
  return count;
}

}  // namespace

size_t CountSignConflicts(const openvdb::FloatTree& tree, float voxel_size) {
  const float limit = voxel_size * 1.001f;
  std::vector<const Leaf*> leaves;
  tree.getNodes(leaves);
  size_t count = ParallelSum(leaves.size(), 64, size_t{0}, [&](size_t begin, size_t end) {
    size_t part = 0;
    Accessor accessor(tree);
    for (size_t i = begin; i < end; ++i) {
      const float* values = leaves[i]->buffer().data();
      part += ConflictsWithin(values, limit);
      for (int axis = 0; axis < 3; ++axis)
        for (int direction : {-1, 1}) part += ConflictsAcross(accessor, *leaves[i], axis, direction, limit);
    }
    return part;
  });
  // The first and the last leaf of each column face the outside.
  std::sort(leaves.begin(), leaves.end(), [](const Leaf* a, const Leaf* b) { return a->origin() < b->origin(); });
  const auto same_column = [&](size_t i, size_t j) {
    return j < leaves.size() && leaves[i]->origin()[0] == leaves[j]->origin()[0] &&
           leaves[i]->origin()[1] == leaves[j]->origin()[1];
  };
  for (size_t i = 0; i < leaves.size(); ++i) {
    const bool first = i == 0 || !same_column(i - 1, i), last = !same_column(i, i + 1);
    count += first && std::signbit(leaves[i]->getValue(0));
    count += last && std::signbit(leaves[i]->getValue(511));
  }
  return count;
}

}  // namespace glint::internal
