#include "sdf/mesh_to_level_set.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "sdf/band_maker.h"
#include "sdf/index_frame.h"
#include "sdf/level_set_impl.h"
#include "sdf/memory_budget.h"
#include "sdf/prepared_mesh.h"
#include "sdf/sign_evidence.h"

namespace glint {

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
                        SdfSummary* summary, std::vector<VoxelClosest>* closest) {
  if (!(voxel_size_world > 0) || !std::isfinite(voxel_size_world))
    throw InputError("", "voxel size", fmt::format("expected a positive length, found {}", voxel_size_world));
  return MeshToLevelSet(mesh, Eigen::Affine3d(Eigen::Scaling(voxel_size_world)), options, summary, closest);
}

namespace {

openvdb::math::Transform::Ptr ToVdb(const Eigen::Affine3d& world_from_index, double voxel_size) {
  if (world_from_index.translation().isZero(0) &&
      (world_from_index.linear() - voxel_size * Eigen::Matrix3d::Identity()).isZero(1e-12 * voxel_size))
    return openvdb::math::Transform::createLinearTransform(voxel_size);
  openvdb::math::Mat4d matrix;  // for row vectors: transposed
  for (int r = 0; r < 4; ++r)
    for (int c = 0; c < 4; ++c) matrix[c][r] = world_from_index.matrix()(r, c);
  return openvdb::math::Transform::createLinearTransform(matrix);
}

// Makes the band by the method asked for; "auto" tries pseudo-normals and looks at what comes out.
openvdb::FloatGrid::Ptr MakeBand(const internal::BandMaker& maker, const internal::PreparedMesh& prepared,
                                 const SdfOptions& options, float voxel_size, SdfSummary& summary) {
  const std::string& sign = options.sign;
  summary.sign = sign;
  summary.reason = "as asked";
  if (sign == "unsigned") return maker.Unsigned();
  if (sign == "winding") return maker.ByWinding();
  if (sign == "pseudonormal") return maker.ByPseudoNormals();
  if (!prepared.balanced) {
    summary.sign = "winding";
    summary.reason = "the mesh is not closed and consistently oriented: " + internal::DescribeEdges(prepared.mesh);
    return maker.ByWinding();
  }
  openvdb::FloatGrid::Ptr grid = maker.ByPseudoNormals();
  const size_t conflicts = internal::CountSignConflicts(grid->tree(), voxel_size);
  if (conflicts > 0) {
    summary.sign = "winding";
    summary.reason = fmt::format(
        "the mesh is closed, but pseudo-normals put {} pairs of neighbouring voxels away from the surface on different "
        "sides: faces pass through each other, or components are inside out or inside others",
        conflicts);
    grid.reset();
    summary.predicted_bytes = CheckGridFits(prepared.mesh, options.half_width_voxels, options.max_memory_gb, true);
    return maker.ByWinding();
  }
  summary.sign = "pseudonormal";
  summary.reason = "the mesh is closed and consistently oriented, and its signs agree with each other";
  return grid;
}

}  // namespace

LevelSet MeshToLevelSet(const TriangleMesh& mesh, const Eigen::Affine3d& world_from_index, const SdfOptions& options,
                        SdfSummary* summary, std::vector<VoxelClosest>* closest) {
  const double voxel_size = internal::VoxelSizeOf(world_from_index);
  if (voxel_size < kSmallestVoxelWorld)
    throw InputError("", "voxel size",
                     fmt::format("expected at least {} (the smallest that OpenVDB can hold), found {:g}; "
                                 "scale the mesh up",
                                 kSmallestVoxelWorld, voxel_size));
  const std::vector<std::string> violations = Violations(options);
  if (!violations.empty()) throw InputError("", "signed distance options", violations.front());
  const internal::PreparedMesh prepared = internal::PrepareMesh(mesh, world_from_index.inverse());
  const bool by_winding = options.sign == "winding" || (options.sign == "auto" && !prepared.balanced);
  SdfSummary story;
  story.predicted_bytes = CheckGridFits(prepared.mesh, options.half_width_voxels, options.max_memory_gb, by_winding);
  internal::BandMaker maker(prepared, options.half_width_voxels, voxel_size);
  if (closest) maker.SetClosest(*closest);
  story.turned = prepared.turned;
  story.degenerate_faces = prepared.collapsed_faces;
  const openvdb::FloatGrid::Ptr grid = MakeBand(maker, prepared, options, static_cast<float>(voxel_size), story);
  story.active_voxels = grid->activeVoxelCount();
  grid->setTransform(ToVdb(world_from_index, voxel_size));
  grid->setGridClass(options.sign == "unsigned" ? openvdb::GRID_UNKNOWN : openvdb::GRID_LEVEL_SET);
  if (summary) *summary = story;
  return MakeLevelSet(grid);
}

}  // namespace glint
