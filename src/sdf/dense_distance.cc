#include "sdf/dense_distance.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/cancel_scope.h"
#include "core/error.h"
#include "sdf/exact_side.h"
#include "sdf/index_frame.h"
#include "sdf/memory_budget.h"
#include "sdf/prepared_mesh.h"
#include "sdf/sign_choice.h"
#include "sdf/tile_candidates.h"
#include "sdf/winding_signs.h"

namespace glint {

namespace {

using internal::kTileDim;
using internal::TileDistances;

constexpr double kTileRadius = 6.0622;

// Copies the part of a tile that lies within the box; `inside`, if given, has the signs.
void Store(const Eigen::Vector3i& origin, const TileDistances& tile, const internal::LeafBits* inside, double scale,
           DenseField& field) {
  const Eigen::Vector3i count = (field.size - origin).cwiseMin(kTileDim);
  const float factor = static_cast<float>(scale);
  for (int x = 0; x < count[0]; ++x)
    for (int y = 0; y < count[1]; ++y) {
      const size_t row = (static_cast<size_t>(origin[0] + x) * static_cast<size_t>(field.size[1]) +
                          static_cast<size_t>(origin[1] + y)) *
                             static_cast<size_t>(field.size[2]) +
                         static_cast<size_t>(origin[2]);
      for (int z = 0; z < count[2]; ++z) {
        float value = factor * tile.distance[x << 6 | y << 3 | z];
        if (inside) value = ((*inside)[static_cast<size_t>(x)] >> (y << 3 | z) & 1) ? -value : value;
        field.values[row + static_cast<size_t>(z)] = value;
      }
    }
}

class NoSide : public internal::ExactSide {
 public:
  bool Inside(const Eigen::Vector3i&, const uint32_t*, size_t, internal::KnownNormals&) const override { return false; }
};

// Computes the tiles of a box one after another along z.
class DenseMaker {
 public:
  DenseMaker(const internal::PreparedMesh& prepared, const std::string& sign)
      : mesh_(prepared.mesh), closest_(prepared.mesh), candidates_(closest_) {
    if (sign == "pseudonormal") {
      exact_.emplace(mesh_);
    } else if (sign == "winding") {
      winding_.emplace(mesh_, prepared.balanced, 1.0);
    }
  }

  void Compute(double scale, DenseField& field) const {
    const Eigen::Vector3i tiles = (field.size.array() + kTileDim - 1) / kTileDim;
    tbb::enumerable_thread_specific<internal::TileScratch> scratches;
    const size_t num_columns = static_cast<size_t>(tiles[0]) * static_cast<size_t>(tiles[1]);
    const Progress& asked = CancelScope::Current();
    tbb::parallel_for(size_t{0}, num_columns, [&](size_t column) {
      asked.ThrowIfCancelled();
      internal::TileScratch& scratch = scratches.local();
      TileDistances distances{};
      std::vector<uint32_t> triangles;
      Eigen::Vector3i origin(static_cast<int>(column / static_cast<size_t>(tiles[1])) * kTileDim,
                             static_cast<int>(column % static_cast<size_t>(tiles[1])) * kTileDim, 0);
      double bound = std::numeric_limits<double>::infinity();
      for (; origin[2] < field.size[2]; origin[2] += kTileDim) {
        const double center = candidates_.Collect(origin, bound, triangles);
        bound = (center + kTileDim) * (1 + 1e-12);  // from the next tile's centre
        const internal::Tile tile{mesh_.vertices.data(),
                                  mesh_.faces.data(),
                                  triangles.data(),
                                  triangles.size(),
                                  origin,
                                  static_cast<float>((center + kTileRadius) * 1.001 + 0.01),
                                  exact_.has_value()};
        internal::ComputeTile(tile, exact_ ? static_cast<const internal::ExactSide&>(*exact_) : no_side_, scratch,
                              distances);
        if (winding_) {
          const internal::LeafBits inside = winding_->Inside(origin, distances);
          Store(origin, distances, &inside, scale, field);
        } else {
          Store(origin, distances, nullptr, scale, field);
        }
      }
    });
  }

 private:
  const TriangleMesh& mesh_;
  ClosestPointQuery closest_;
  internal::TileCandidates candidates_;
  NoSide no_side_;
  std::optional<internal::PseudoNormalSide> exact_;
  std::optional<internal::WindingSigner> winding_;
};

}  // namespace

DenseField DenseSignedDistance(const TriangleMesh& mesh, const Eigen::Affine3d& world_from_index,
                               const Eigen::Vector3i& size, const std::string& sign, SdfSummary* summary) {
  const double voxel_size = internal::VoxelSizeOf(world_from_index);
  const std::vector<std::string> violations = Violations(SdfOptions{.sign = sign});
  if (!violations.empty()) throw InputError("", "signed distance options", violations.front());
  if (!(size.minCoeff() > 0))
    throw InputError("", "grid size",
                     fmt::format("expected positive numbers, found {} × {} × {}", size[0], size[1], size[2]));
  const internal::PreparedMesh prepared = internal::PrepareMesh(mesh, world_from_index.inverse());
  SdfSummary story;
  story.turned = prepared.turned;
  story.degenerate_faces = prepared.collapsed_faces;
  story.predicted_bytes = CheckDenseFits(size.cast<double>().prod(), prepared.mesh.faces.size());
  story.sign = sign;
  story.reason = "as asked";
  if (sign == "auto") internal::ChooseSign(prepared, story);
  DenseField field;
  field.size = size;
  story.active_voxels = static_cast<size_t>(size[0]) * static_cast<size_t>(size[1]) * static_cast<size_t>(size[2]);
  field.values.resize(story.active_voxels);
  DenseMaker(prepared, story.sign).Compute(voxel_size, field);
  if (summary) *summary = story;
  return field;
}

}  // namespace glint
