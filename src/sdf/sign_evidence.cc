#include "sdf/sign_evidence.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/parallel.h"

namespace glint::internal {

namespace {

using Leaf = openvdb::FloatTree::LeafNodeType;
using openvdb::Coord;

bool Conflict(float a, float b, float limit) {
  return std::signbit(a) != std::signbit(b) && std::abs(a) + std::abs(b) > limit;
}

// Between voxels a and a + stride along the axis of that stride.
size_t ConflictsWithin(const float* values, int stride, float limit) {
  size_t count = 0;
  for (int i = 0; i < 512; ++i) {
    const bool last = (i / stride & 7) == 7;
    const float a = values[i], b = values[last ? i : i + stride];
    count += Conflict(a, b, limit);
  }
  return count;
}

// With the leaf or the tile on one side of an axis.
size_t ConflictsAcross(const openvdb::FloatTree& tree, const Leaf& leaf, int axis, int direction, float limit) {
  Coord beside = leaf.origin();
  beside[axis] += direction * 8;
  const Leaf* other = tree.probeConstLeaf(beside);
  if (other != nullptr && direction < 0) return 0;  // the other one counts
  const float tile = other ? 0 : tree.getValue(beside);
  const int stride = axis == 0 ? 64 : axis == 1 ? 8 : 1;
  const int u = axis == 0 ? 8 : 64, v = axis == 2 ? 8 : 1;
  size_t count = 0;
  for (int i = 0; i < 8; ++i)
    for (int j = 0; j < 8; ++j) {
      const int at = u * i + v * j;
      const float mine = leaf.getValue(static_cast<openvdb::Index>(at + (direction > 0 ? 7 * stride : 0)));
      count += Conflict(mine, other ? other->getValue(static_cast<openvdb::Index>(at)) : tile, limit);
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
    for (size_t i = begin; i < end; ++i) {
      const float* values = leaves[i]->buffer().data();
      for (int stride : {1, 8, 64}) part += ConflictsWithin(values, stride, limit);
      for (int axis = 0; axis < 3; ++axis)
        for (int direction : {-1, 1}) part += ConflictsAcross(tree, *leaves[i], axis, direction, limit);
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
