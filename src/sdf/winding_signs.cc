#include "sdf/winding_signs.h"

#include <array>
#include <cmath>
#include <numeric>

#include "core/parallel.h"

namespace glint::internal {

namespace {

constexpr double kTileRadius = 6.0622;
// The expansion of the winding number is off by less than 0.01.
constexpr double kWindingError = 0.03;

Eigen::Vector3d VoxelAt(const Eigen::Vector3i& origin, int offset) {
  return (origin + Eigen::Vector3i(offset >> 6, offset >> 3 & 7, offset & 7)).cast<double>();
}

// The regions of a leaf that no surface cuts: of neighbouring voxels whose distances sum to more than one voxel, both
// are on the same side.
std::array<uint16_t, kTileVoxels> FindRegions(const TileDistances& distances, float half_width) {
  std::array<uint16_t, kTileVoxels> parent;
  std::iota(parent.begin(), parent.end(), uint16_t{0});
  const auto root = [&](uint16_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  std::array<float, kTileVoxels> d;
  for (int i = 0; i < kTileVoxels; ++i)
    d[i] = (distances.active[i >> 6] >> (i & 63) & 1) ? std::abs(distances.distance[i]) : half_width;
  const auto join = [&](int i, int j) {
    if (!(d[i] + d[j] > 1.001f)) return;
    const uint16_t a = root(static_cast<uint16_t>(i)), b = root(static_cast<uint16_t>(j));
    parent[std::max(a, b)] = std::min(a, b);
  };
  for (int i = 0; i < kTileVoxels; ++i) {
    if ((i & 7) < 7) join(i, i + 1);
    if ((i >> 3 & 7) < 7) join(i, i + 8);
    if ((i >> 6) < 7) join(i, i + 64);
  }
  for (int i = 0; i < kTileVoxels; ++i) parent[i] = root(static_cast<uint16_t>(i));
  return parent;
}

}  // namespace

WindingSigner::WindingSigner(const TriangleMesh& mesh, bool balanced, double half_width_voxels)
    : mesh_(&mesh),
      balanced_(balanced),
      half_width_(half_width_voxels),
      bvh_(mesh),
      winding_(mesh, bvh_),
      boundary_(mesh) {}

LeafBits WindingSigner::Inside(const Eigen::Vector3i& origin, const TileDistances& distances) const {
  const Eigen::Vector3d center = origin.cast<double>() + Eigen::Vector3d::Constant(3.5);
  // A path within a region may wind about; twice across the leaf is allowed for.
  const double change = balanced_ ? 0 : 4 * kTileRadius * boundary_.GradientBound(center, kTileRadius);
  const std::array<uint16_t, kTileVoxels> region = FindRegions(distances, static_cast<float>(half_width_));
  std::array<double, kTileVoxels> winding;
  LeafBits inside{};
  for (int i = 0; i < kTileVoxels; ++i) {
    const int root = region[i];
    if (root == i) winding[i] = winding_(VoxelAt(origin, i));  // roots are the lowest of their regions
    const bool certain = std::abs(winding[root] - 0.5) > change + kWindingError;
    const double w = root == i || certain ? winding[root] : winding_(VoxelAt(origin, i));
    inside[i >> 6] |= uint64_t{w > 0.5} << (i & 63);
  }
  return inside;
}

WindingSigner::Side WindingSigner::SideOfCube(const Eigen::Vector3d& center, double radius) const {
  const double w = winding_(center);
  const double change = balanced_ ? 0 : radius * boundary_.GradientBound(center, radius);
  if (std::abs(w - 0.5) > change + kWindingError || balanced_) return w > 0.5 ? Side::kInside : Side::kOutside;
  return Side::kMixed;
}

LeafBits WindingSigner::InsideOfFreeLeaf(const Eigen::Vector3i& origin) const {
  LeafBits inside{};
  for (int i = 0; i < kTileVoxels; ++i) inside[i >> 6] |= uint64_t{InsideAt(VoxelAt(origin, i))} << (i & 63);
  return inside;
}

void WindingSigner::FillTiles(openvdb::FloatTree& tree) const {
  using Node1 = openvdb::FloatTree::RootNodeType::ChildNodeType::ChildNodeType;  // 16³ leaves
  const float background = tree.background();
  const Eigen::AlignedBox3d box = BoundingBox(*mesh_);
  constexpr int kDim = 128;
  Eigen::Vector3i low, high;
  for (int k = 0; k < 3; ++k) {
    low[k] = static_cast<int>(std::floor(box.min()[k] / kDim));
    high[k] = static_cast<int>(std::floor(box.max()[k] / kDim));
  }
  // Nodes without leaves: one value where that will do, else tiles.
  for (int x = low[0]; x <= high[0]; ++x)
    for (int y = low[1]; y <= high[1]; ++y)
      for (int z = low[2]; z <= high[2]; ++z) {
        const openvdb::Coord origin(kDim * x, kDim * y, kDim * z);
        if (tree.probeConstNode<Node1>(origin) != nullptr) continue;
        const Eigen::Vector3d center = kDim * Eigen::Vector3d(x + 0.5, y + 0.5, z + 0.5);
        const Side side = SideOfCube(center, 0.5 * kDim * std::sqrt(3.0));
        tree.addTile(2, origin, side == Side::kInside ? -background : background, false);
        if (side == Side::kMixed) tree.addTile(1, origin, background, false);  // makes the node
      }
  struct FreeTile {
    Node1* node;
    openvdb::Index slot;
    Side side = Side::kOutside;
    LeafBits inside{};
  };
  std::vector<FreeTile> tiles;
  std::vector<Node1*> nodes;
  tree.getNodes(nodes);
  for (Node1* node : nodes)
    for (auto it = node->beginChildOff(); it; ++it) tiles.push_back({node, it.pos()});
  const auto origin_of = [](const FreeTile& tile) {
    const openvdb::Coord at = tile.node->offsetToGlobalCoord(tile.slot);
    return Eigen::Vector3i(at[0], at[1], at[2]);
  };
  ParallelFor(tiles.size(), 16, [&](size_t i) {
    FreeTile& tile = tiles[i];
    const Eigen::Vector3d center = origin_of(tile).cast<double>() + Eigen::Vector3d::Constant(3.5);
    if (box.squaredExteriorDistance(center) > kTileRadius * kTileRadius) return;  // beyond the mesh's box: outside
    tile.side = SideOfCube(center, kTileRadius);
    if (tile.side != Side::kMixed) return;
    tile.inside = InsideOfFreeLeaf(origin_of(tile));
    uint64_t any = 0, all = ~uint64_t{0};
    for (uint64_t word : tile.inside) any |= word, all &= word;
    if (any == 0) tile.side = Side::kOutside;
    if (all == ~uint64_t{0}) tile.side = Side::kInside;
  });
  for (const FreeTile& tile : tiles) {
    const Eigen::Vector3i origin = origin_of(tile);
    const openvdb::Coord ijk(origin[0], origin[1], origin[2]);
    if (tile.side != Side::kMixed) {
      tree.addTile(1, ijk, tile.side == Side::kInside ? -background : background, false);
      continue;
    }
    auto leaf = std::make_unique<Leaf>(ijk, background, false);
    for (int i = 0; i < kTileVoxels; ++i)
      if (tile.inside[i >> 6] >> (i & 63) & 1) leaf->setValueOff(static_cast<openvdb::Index>(i), -background);
    tree.addLeaf(leaf.release());
  }
}

}  // namespace glint::internal
