#include "pipeline/memory.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/available_memory.h"
#include "core/error.h"

namespace glint {
namespace {

constexpr uint64_t kUnlimited = std::numeric_limits<uint64_t>::max();

// Bytes a voxel of the finest band while it is solved for (OpenVDB grids, flat arrays, solver vectors), and of the
// wider band that keeps the seed: measured as peak memory over the number of active voxels, rounded up.
constexpr double kBytesPerSolvedVoxel = 400;
constexpr double kBytesPerSeedVoxel = 60;
constexpr double kGiB = 1024.0 * 1024 * 1024;

}  // namespace

uint64_t EstimateRefineMemory(const TriangleMesh& seed, const RefineOptions& options) {
  const double voxel = options.voxel_rel * Diagonal(seed);
  const double voxels_per_layer = SurfaceArea(seed) / (voxel * voxel);
  const double solved = 2 * options.half_width_voxels * voxels_per_layer;
  const double kept = 2 * std::max(8.0, 2 * options.half_width_voxels) * voxels_per_layer;
  const double bytes = solved * kBytesPerSolvedVoxel + kept * kBytesPerSeedVoxel;
  return bytes < 1e18 ? static_cast<uint64_t>(bytes) : kUnlimited;
}

void CheckRefineMemory(const TriangleMesh& seed, const RefineOptions& options, double fraction) {
  const double needed = static_cast<double>(EstimateRefineMemory(seed, options));
  const double allowed = fraction * static_cast<double>(AvailableMemory());
  if (needed <= allowed) return;
  throw InputError(
      "", fmt::format("refine.voxel_rel = {:g}", options.voxel_rel),
      fmt::format("the level set would need about {:.1f} GiB, {:.1f} GiB may be used (output.memory_fraction of "
                  "what is free); {:.2g} or larger would fit",
                  needed / kGiB, allowed / kGiB, options.voxel_rel * std::sqrt(needed / allowed)));
}

}  // namespace glint
