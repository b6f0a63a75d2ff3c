// The inner loop of the narrow band: distances of the 8³ voxels of one tile to the triangles near it, in SIMD by
// runtime dispatch (AVX-512, AVX2, SSE4, scalar).
//
// All arithmetic is in voxels about the centre of the tile, so single precision is good to about 1e-6 of the tile's
// reach whatever the size of the grid or of a triangle; the frames of the triangles are worked out in double. A voxel's
// distance is the smallest over its candidates. Its sign needs no feature in most cases: N of the closest feature is a
// positive combination of the normals of the faces around it, all of which are as close; so if all (nearly) closest
// candidates see the voxel on the same side of their planes, that is its side. The rest is left to ExactSide, in
// double.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace glint::internal {

inline constexpr int kTileDim = 8;
inline constexpr int kTileVoxels = 512;

// Triangles in index space, and which of them to look at: all that come closer than the half width to the tile.
struct Tile {
  const Eigen::Vector3d* vertices;
  const Eigen::Vector3i* faces;
  const uint32_t* triangles;
  size_t num_triangles;
  Eigen::Vector3i origin;  // its first voxel
  float half_width;        // voxels
  bool is_signed;
  bool wants_closest = false;  // fill in TileDistances::closest
};

// Pseudo-normals that came up in a tile: neighbouring voxels have the closest feature in common.
struct KnownNormals {
  struct Entry {
    int first = -1, second = -1;  // vertices of an edge; a vertex has no second
    Eigen::Vector3d normal;
  };
  std::array<Entry, 32> entries;

  Entry& At(int first, int second) {
    return entries[(7 * static_cast<size_t>(first) + static_cast<size_t>(second + 1)) % entries.size()];
  }
};

// Decides the voxels that single precision cannot.
class ExactSide {
 public:
  virtual ~ExactSide() = default;
  // True if the voxel is inside, given every triangle that may be closest to it.
  virtual bool Inside(const Eigen::Vector3i& voxel, const uint32_t* triangles, size_t num_triangles,
                      KnownNormals& known) const = 0;
};

struct TileDistances {
  alignas(64) float distance[kTileVoxels];  // voxels, negative inside; only where active
  uint64_t active[8];                       // bit y << 3 | z of word x: |distance| < half width
  uint64_t inside[8];                       // likewise: active and inside
  bool any_active;
  uint32_t closest[kTileVoxels];  // the closest triangle, to single precision; only where active and asked for
};

struct TileCounters {
  uint64_t tiles = 0, tile_triangles = 0, kept_triangles = 0, blocks = 0, candidates = 0, exact = 0;
};

struct alignas(64) Pack {
  float lane[16];
};

// Work space of one thread.
struct TileScratch {
  std::vector<double> corners;        // 9 arrays
  std::vector<Pack> spheres;          // centre and radius, 4 packs a group of 16 triangles
  std::vector<Pack> frames;           // kNumCoefficients packs a group
  std::vector<Pack> squared;          // of the candidates of a block, 16 voxels each
  std::vector<Pack> center_distance;  // of the centres of all blocks from each triangle, 2 packs
  std::vector<uint32_t> tile_ids;     // the triangles by their place in the arrays above
  std::vector<uint32_t> kept, candidates, ties;
  std::vector<uint32_t> wanted;  // of each triangle: a bit for each block that needs it
  KnownNormals known;            // of the current tile
  TileCounters counters;
};

void ComputeTile(const Tile& tile, const ExactSide& exact, TileScratch& scratch, TileDistances& out);

// The 512 values of a leaf: scale times the distances where active, else `background`; negative where `inside` says.
void WriteLeaf(const TileDistances& distances, const uint64_t* inside, float scale, float background, float* to);

// The instruction set in use, for reports.
const char* TileKernelTarget();

}  // namespace glint::internal
