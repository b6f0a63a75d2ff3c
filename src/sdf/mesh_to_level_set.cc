#include "sdf/mesh_to_level_set.h"

#include <fmt/format.h>
#include <openvdb/tools/SignedFloodFill.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/parallel.h"
#include "geometry/clean_mesh.h"
#include "sdf/level_set_impl.h"
#include "sdf/memory_budget.h"
#include "sdf/signed_distance.h"

namespace glint {

namespace {

using openvdb::Coord;
using Leaf = openvdb::FloatTree::LeafNodeType;
constexpr int kLeafDim = 8;

// Leaves that may hold voxels closer than `reach` voxels to the mesh (in index space), in order.
std::vector<Coord> LeavesNear(const TriangleMesh& mesh, double reach) {
  std::vector<Coord> leaves;
  for (const Eigen::Vector3i& face : mesh.faces) {
    Eigen::AlignedBox3d box;
    for (int k = 0; k < 3; ++k) box.extend(mesh.vertices[face[k]]);
    Eigen::Vector3i low, high;
    for (int k = 0; k < 3; ++k) {
      low[k] = static_cast<int>(std::floor((box.min()[k] - reach) / kLeafDim));
      high[k] = static_cast<int>(std::floor((box.max()[k] + reach) / kLeafDim));
    }
    for (int x = low[0]; x <= high[0]; ++x)
      for (int y = low[1]; y <= high[1]; ++y)
        for (int z = low[2]; z <= high[2]; ++z) {
          const Eigen::Vector3d center = kLeafDim * Eigen::Vector3d(x, y, z) + Eigen::Vector3d::Constant(3.5);
          const double limit = reach + 3.5 * std::sqrt(3.0);
          const Eigen::Vector3d* v = mesh.vertices.data();
          if (ClosestOnTriangle(v[face[0]], v[face[1]], v[face[2]], center).squared_distance <= limit * limit)
            leaves.emplace_back(kLeafDim * x, kLeafDim * y, kLeafDim * z);
        }
    if (leaves.size() > (size_t{1} << 22)) {
      std::sort(leaves.begin(), leaves.end());
      leaves.erase(std::unique(leaves.begin(), leaves.end()), leaves.end());
    }
  }
  std::sort(leaves.begin(), leaves.end());
  leaves.erase(std::unique(leaves.begin(), leaves.end()), leaves.end());
  return leaves;
}

}  // namespace

void SdfOptions::Visit(OptionVisitor& v) {
  v.Field(
      {.name = "half_width_voxels", .help = "half width of the narrow band", .unit = "voxels", .min = 1, .max = 1e4},
      half_width_voxels);
  v.Field({.name = "sign",
           .help = "how inside is told from outside",
           .choices = {"auto", "pseudonormal", "winding", "unsigned"}},
          sign);
  v.Field({.name = "max_memory_gb", .help = "refuse grids that need more; 0: what is free", .unit = "GB", .min = 0},
          max_memory_gb);
}

LevelSet MeshToLevelSet(const TriangleMesh& mesh, double voxel_size_world, const SdfOptions& options,
                        SdfSummary* summary) {
  if (!(voxel_size_world > 0) || !std::isfinite(voxel_size_world))
    throw InputError("", "voxel size", fmt::format("expected a positive length, found {}", voxel_size_world));
  return MeshToLevelSet(mesh, Eigen::Affine3d(Eigen::Scaling(voxel_size_world)), options, summary);
}

LevelSet MeshToLevelSet(const TriangleMesh& mesh, const Eigen::Affine3d& world_from_index, const SdfOptions& options,
                        SdfSummary* summary) {
  const double voxel_size = std::cbrt(std::abs(world_from_index.linear().determinant()));
  const std::vector<std::string> violations = Violations(options);
  if (!violations.empty()) throw InputError("", "signed distance options", violations.front());
  TriangleMesh in_index = Clean(mesh).mesh;
  const Eigen::Affine3d index_from_world = world_from_index.inverse();
  for (Eigen::Vector3d& v : in_index.vertices) v = index_from_world * v;
  const double half_width = options.half_width_voxels;
  CheckGridFits(in_index, half_width, options.max_memory_gb);

  const SignedDistanceQuery query(in_index, options.sign);
  const std::vector<Coord> origins = LeavesNear(in_index, half_width);
  const bool is_signed = query.method() != "unsigned";
  const float background = static_cast<float>(half_width * voxel_size);
  std::vector<std::unique_ptr<Leaf>> leaves(origins.size());
  ParallelFor(origins.size(), 4, [&](size_t i) {
    auto leaf = std::make_unique<Leaf>(origins[i], background);
    for (openvdb::Index n = 0; n < Leaf::SIZE; ++n) {
      const Coord ijk = leaf->offsetToGlobalCoord(n);
      const auto distance = query.Find({double(ijk[0]), double(ijk[1]), double(ijk[2])}, half_width);
      if (distance && std::abs(*distance) < half_width) leaf->setValueOn(n, static_cast<float>(*distance * voxel_size));
    }
    if (!leaf->isEmpty()) leaves[i] = std::move(leaf);
  });
  auto grid = openvdb::FloatGrid::create(background);
  for (auto& leaf : leaves)
    if (leaf) grid->tree().addLeaf(leaf.release());
  if (is_signed) openvdb::tools::signedFloodFill(grid->tree());
  openvdb::math::Mat4d matrix = openvdb::math::Mat4d::identity();  // row vectors: transposed
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 4; ++c) matrix[c][r] = world_from_index.matrix()(r, c);
  if (world_from_index.linear().isApprox(voxel_size * Eigen::Matrix3d::Identity()) &&
      world_from_index.translation().isZero(0)) {
    grid->setTransform(openvdb::math::Transform::createLinearTransform(voxel_size));
  } else {
    grid->setTransform(openvdb::math::Transform::createLinearTransform(matrix));
  }
  grid->setGridClass(is_signed ? openvdb::GRID_LEVEL_SET : openvdb::GRID_UNKNOWN);
  if (summary) {
    *summary = query.summary();
    summary->active_voxels = grid->activeVoxelCount();
  }
  return MakeLevelSet(grid);
}

}  // namespace glint
