#include "sdf/tile_binning.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "geometry/closest_point.h"

namespace glint::internal {

namespace {

using Eigen::Vector3d;
using Eigen::Vector3i;

constexpr double kTileRadius = 6.0622;  // of the voxel centres about the tile's centre

// Tiles, by their coordinates divided by 8.
struct TileRange {
  Vector3i low, high;
  size_t Count() const {
    return (high.array() < low.array()).any()
               ? 0
               : size_t(high[0] - low[0] + 1) * size_t(high[1] - low[1] + 1) * size_t(high[2] - low[2] + 1);
  }
};

TileRange RangeOf(const TriangleMesh& mesh, size_t f, double reach) {
  const Vector3i& face = mesh.faces[f];
  const Vector3d &a = mesh.vertices[face[0]], &b = mesh.vertices[face[1]], &c = mesh.vertices[face[2]];
  TileRange range;
  for (int k = 0; k < 3; ++k) {  // a tile's voxels span [8 t, 8 t + 7]
    const double low = std::min({a[k], b[k], c[k]}) - reach, high = std::max({a[k], b[k], c[k]}) + reach;
    range.low[k] = static_cast<int>(std::ceil((low - 7) / 8));
    range.high[k] = static_cast<int>(std::floor(high / 8));
  }
  return range;
}

// Visits the tiles of `range` that triangle f comes near.
template <class Visit>
void ForTilesNear(const TriangleMesh& mesh, size_t f, const TileRange& range, double reach, const Visit& visit) {
  const Vector3i& face = mesh.faces[f];
  const Vector3d &a = mesh.vertices[face[0]], &b = mesh.vertices[face[1]], &c = mesh.vertices[face[2]];
  const bool few = range.Count() <= 8;
  const Vector3d n = (b - a).cross(c - a).normalized();
  const bool has_plane = n.allFinite();
  const double near_plane = reach + 3.5 * n.cwiseAbs().sum() + 1e-6;
  const double limit = (reach + kTileRadius) * (reach + kTileRadius);
  for (int x = range.low[0]; x <= range.high[0]; ++x)
    for (int y = range.low[1]; y <= range.high[1]; ++y)
      for (int z = range.low[2]; z <= range.high[2]; ++z) {
        if (!few) {
          const Vector3d center(8.0 * x + 3.5, 8.0 * y + 3.5, 8.0 * z + 3.5);
          if (has_plane && std::abs(n.dot(center - a)) > near_plane) continue;
          if (ClosestOnTriangle(a, b, c, center).squared_distance > limit) continue;
        }
        visit(x, y, z);
      }
}

// A cube of tiles, the unit of parallel work. Pairs are sorted by tile within it.
struct Bricks {
  Vector3i low;      // tile coordinates of the first
  Vector3i count;    // bricks along each axis
  int log2_dim = 4;  // tiles along each axis of a brick
  size_t Total() const { return size_t(count[0]) * size_t(count[1]) * size_t(count[2]); }
  size_t Index(int x, int y, int z) const {
    return (size_t(x) * size_t(count[1]) + size_t(y)) * size_t(count[2]) + size_t(z);
  }
};

// At most 2^15 bricks, however large the grid.
Bricks LayOut(const TriangleMesh& mesh, double reach) {
  const Eigen::AlignedBox3d box = BoundingBox(mesh);
  Vector3i low, high;
  for (int k = 0; k < 3; ++k) {
    low[k] = static_cast<int>(std::ceil((box.min()[k] - reach - 7) / 8));
    high[k] = static_cast<int>(std::floor((box.max()[k] + reach) / 8));
  }
  Bricks bricks;
  bricks.low = low;
  for (bricks.log2_dim = 3;; ++bricks.log2_dim) {
    for (int k = 0; k < 3; ++k) bricks.count[k] = ((high[k] - low[k]) >> bricks.log2_dim) + 1;
    if (bricks.Total() <= (1u << 15)) return bricks;
  }
}

struct BrickTiles {
  std::vector<Vector3i> origin;
  std::vector<uint32_t> count, triangles;
};

// The triangles of each brick, ascending: first[b] … first[b + 1].
struct BrickLists {
  std::vector<size_t> first;
  std::vector<uint32_t> triangles;
};

template <class Visit>
void ForBricks(const Bricks& bricks, const TileRange& range, const Visit& visit) {
  const int s = bricks.log2_dim;
  const Vector3i low = range.low - bricks.low, high = range.high - bricks.low;
  for (int x = low[0] >> s; x <= high[0] >> s; ++x)
    for (int y = low[1] >> s; y <= high[1] >> s; ++y)
      for (int z = low[2] >> s; z <= high[2] >> s; ++z) visit(bricks.Index(x, y, z));
}

BrickLists SortIntoBricks(const TriangleMesh& mesh, const Bricks& bricks, double reach) {
  const size_t num_faces = mesh.faces.size(), num_bricks = bricks.Total();
  const size_t num_chunks = std::clamp<size_t>(num_faces / 8192, 1, std::max<size_t>((1u << 22) / num_bricks, 1));
  const size_t chunk = (num_faces + num_chunks - 1) / num_chunks;
  // counts[c][b]: triangles of chunk c in brick b; then where they go.
  std::vector<size_t> next(num_chunks * num_bricks, 0);
  ParallelFor(num_chunks, 1, [&](size_t c) {
    size_t* counts = next.data() + c * num_bricks;
    for (size_t f = c * chunk; f < std::min(num_faces, (c + 1) * chunk); ++f)
      ForBricks(bricks, RangeOf(mesh, f, reach), [&](size_t b) { ++counts[b]; });
  });
  BrickLists lists;
  lists.first.resize(num_bricks + 1);
  size_t total = 0;
  for (size_t b = 0; b < num_bricks; ++b) {
    lists.first[b] = total;
    for (size_t c = 0; c < num_chunks; ++c) {
      const size_t count = next[c * num_bricks + b];
      next[c * num_bricks + b] = total;
      total += count;
    }
  }
  lists.first[num_bricks] = total;
  lists.triangles.resize(total);
  ParallelFor(num_chunks, 1, [&](size_t c) {
    size_t* to = next.data() + c * num_bricks;
    for (size_t f = c * chunk; f < std::min(num_faces, (c + 1) * chunk); ++f)
      ForBricks(bricks, RangeOf(mesh, f, reach),
                [&](size_t b) { lists.triangles[to[b]++] = static_cast<uint32_t>(f); });
  });
  return lists;
}

BrickTiles SortIntoTiles(const TriangleMesh& mesh, const Bricks& bricks, size_t brick, const uint32_t* triangles,
                         size_t num_triangles, double reach) {
  const int s = bricks.log2_dim, dim = 1 << s;
  const Vector3i position(static_cast<int>(brick / (size_t(bricks.count[1]) * size_t(bricks.count[2]))),
                          static_cast<int>(brick / size_t(bricks.count[2]) % size_t(bricks.count[1])),
                          static_cast<int>(brick % size_t(bricks.count[2])));
  const Vector3i low = bricks.low + (position * dim), high = low + Vector3i::Constant(dim - 1);
  struct Pair {
    uint64_t tile;
    uint32_t triangle;
  };
  std::vector<Pair> pairs;
  for (size_t i = 0; i < num_triangles; ++i) {
    TileRange range = RangeOf(mesh, triangles[i], reach);
    range.low = range.low.cwiseMax(low);
    range.high = range.high.cwiseMin(high);
    ForTilesNear(mesh, triangles[i], range, reach, [&](int x, int y, int z) {
      const uint64_t tile = (uint64_t(x - low[0]) << s | uint64_t(y - low[1])) << s | uint64_t(z - low[2]);
      pairs.push_back({tile, triangles[i]});
    });
  }
  BrickTiles out;
  const auto add_tile = [&](uint64_t tile, uint32_t count) {
    const uint64_t mask = uint64_t(dim) - 1;
    const Vector3i at(static_cast<int>(tile >> (2 * s)), static_cast<int>(tile >> s & mask),
                      static_cast<int>(tile & mask));
    out.origin.push_back(8 * (low + at));
    out.count.push_back(count);
  };
  out.triangles.resize(pairs.size());
  if (s > 5) {  // too many tiles to count each
    std::stable_sort(pairs.begin(), pairs.end(), [](const Pair& p, const Pair& q) { return p.tile < q.tile; });
    for (size_t i = 0, begin = 0; i < pairs.size(); ++i) {
      out.triangles[i] = pairs[i].triangle;
      if (i + 1 < pairs.size() && pairs[i + 1].tile == pairs[i].tile) continue;
      add_tile(pairs[i].tile, static_cast<uint32_t>(i + 1 - begin));
      begin = i + 1;
    }
    return out;
  }
  std::vector<uint32_t> next(size_t{1} << (3 * s), 0);
  for (const Pair& p : pairs) ++next[p.tile];
  uint32_t total = 0;
  for (size_t tile = 0; tile < next.size(); ++tile) {
    const uint32_t count = next[tile];
    next[tile] = total;
    total += count;
    if (count > 0) add_tile(tile, count);
  }
  for (const Pair& p : pairs) out.triangles[next[p.tile]++] = p.triangle;
  return out;
}

}  // namespace

TileBins BinTriangles(const TriangleMesh& mesh, double reach) {
  const Bricks bricks = LayOut(mesh, reach);
  const BrickLists lists = SortIntoBricks(mesh, bricks, reach);
  std::vector<BrickTiles> parts(bricks.Total());
  ParallelFor(parts.size(), 1, [&](size_t b) {
    const size_t begin = lists.first[b], end = lists.first[b + 1];
    if (begin < end) parts[b] = SortIntoTiles(mesh, bricks, b, lists.triangles.data() + begin, end - begin, reach);
  });
  std::vector<size_t> first_tile(parts.size() + 1, 0), first_triangle(parts.size() + 1, 0);
  for (size_t b = 0; b < parts.size(); ++b) {
    first_tile[b + 1] = first_tile[b] + parts[b].origin.size();
    first_triangle[b + 1] = first_triangle[b] + parts[b].triangles.size();
  }
  TileBins bins;
  bins.origin.resize(first_tile.back());
  bins.first.resize(first_tile.back() + 1);
  bins.triangles.resize(first_triangle.back());
  bins.first.back() = first_triangle.back();
  ParallelFor(parts.size(), 1, [&](size_t b) {
    std::copy(parts[b].origin.begin(), parts[b].origin.end(), bins.origin.begin() + first_tile[b]);
    std::copy(parts[b].triangles.begin(), parts[b].triangles.end(), bins.triangles.begin() + first_triangle[b]);
    size_t at = first_triangle[b];
    for (size_t i = 0; i < parts[b].count.size(); ++i) {
      bins.first[first_tile[b] + i] = at;
      at += parts[b].count[i];
    }
    parts[b] = {};
  });
  return bins;
}

}  // namespace glint::internal
