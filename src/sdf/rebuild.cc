#include "sdf/rebuild.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "geometry/closest_point.h"
#include "sdf/band_maker.h"
#include "sdf/extract_mesh.h"
#include "sdf/field_sampler.h"
#include "sdf/level_set_impl.h"
#include "sdf/memory_budget.h"
#include "sdf/prepared_mesh.h"

namespace glint {

namespace {

// How far, in voxels of either grid, the smooth surface may lie from the facets of its mesh.
constexpr double kReach = 0.25;

// Replaces the closest point c of the mesh by the point of the smooth zero set beside it, one Newton step along the
// gradient: the facets cut the corners of round surfaces by up to 1/(8 R) voxels, the correction leaves their square.
class ToSmoothSurface : public internal::DistanceCorrection {
 public:
  ToSmoothSurface(const TriangleMesh& mesh_in_index, const openvdb::FloatGrid& field,
                  const Eigen::Affine3d& field_from_index)
      : mesh_(mesh_in_index), field_(field), field_from_index_(field_from_index) {}

  void Correct(const Eigen::Vector3i& origin, internal::TileDistances& distances) const override {
    internal::FieldSampler sampler(field_.tree());
    for (int i = 0; i < internal::kTileVoxels; ++i) {
      if (!(distances.active[i >> 6] >> (i & 63) & 1)) continue;
      const Eigen::Vector3d p = (origin + Eigen::Vector3i(i >> 6, i >> 3 & 7, i & 7)).cast<double>();
      distances.distance[i] = static_cast<float>(Corrected(p, distances.closest[i], distances.distance[i], sampler));
    }
  }

 private:
  double Corrected(const Eigen::Vector3d& p, uint32_t triangle, double distance,
                   internal::FieldSampler& sampler) const {
    const Eigen::Vector3i& f = mesh_.faces[triangle];
    const Eigen::Vector3d c =
        ClosestOnTriangle(mesh_.vertices[f[0]], mesh_.vertices[f[1]], mesh_.vertices[f[2]], p).point;
    const internal::FieldSample sample = sampler(ToVdb(field_from_index_ * c));
    const Eigen::Vector3d gradient = field_from_index_.linear().transpose() * FromVdb(sample.gradient);
    const double squared = gradient.squaredNorm();
    if (!(squared > 0)) return distance;
    const Eigen::Vector3d step = gradient * (-sample.value / squared);
    if (!(step.norm() < kReach)) return distance;  // not a distance field there
    const Eigen::Vector3d r = p - (c + step);
    // Next to the surface the step may have crossed the voxel.
    const bool inside = std::abs(distance) < 2 * kReach ? r.dot(gradient) < 0 : distance < 0;
    return inside ? -r.norm() : r.norm();
  }

  const TriangleMesh& mesh_;
  const openvdb::FloatGrid& field_;
  Eigen::Affine3d field_from_index_;
};

Eigen::Affine3d WorldFromIndex(const LevelSet& level_set) {
  Eigen::Affine3d world_from_index = Eigen::Affine3d::Identity();
  const auto matrix = level_set.impl().grid->transform().baseMap()->getAffineMap()->getMat4();
  for (int r = 0; r < 4; ++r)
    for (int c = 0; c < 4; ++c) world_from_index.matrix()(r, c) = matrix[c][r];  // OpenVDB multiplies row vectors
  return world_from_index;
}

LevelSet Rebuild(const LevelSet& level_set, double voxel_size, double half_width_voxels) {
  if (!(half_width_voxels >= 1) || !std::isfinite(half_width_voxels))
    throw InputError("", "half width", fmt::format("expected at least 1 voxel, found {}", half_width_voxels));
  const TriangleMesh surface = ExtractMesh(level_set);
  if (surface.faces.empty()) throw InputError("", "level set", "expected a zero set, found none");
  const openvdb::FloatGrid& field = *level_set.impl().grid;
  const Eigen::Affine3d world_from_field = WorldFromIndex(level_set);
  Eigen::Affine3d world_from_index = world_from_field;
  const double ratio = voxel_size / level_set.voxel_size();
  if (ratio != 1) world_from_index.linear() *= ratio;
  const internal::PreparedMesh prepared = internal::PrepareMesh(surface, world_from_index.inverse(), false);
  CheckGridFits(prepared.mesh, half_width_voxels, 0);
  const ToSmoothSurface correction(prepared.mesh, field, world_from_field.inverse() * world_from_index);
  internal::BandMaker maker(prepared, half_width_voxels, voxel_size);
  maker.SetCorrection(correction, kReach);
  const openvdb::FloatGrid::Ptr grid = prepared.balanced ? maker.ByPseudoNormals() : maker.ByWinding();
  openvdb::math::Transform::Ptr transform = field.transform().copy();
  if (ratio != 1) transform->preScale(ratio);
  grid->setTransform(transform);
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  return MakeLevelSet(grid);
}

}  // namespace

LevelSet Redistance(const LevelSet& level_set, double half_width_voxels) {
  if (level_set.empty()) throw InputError("", "level set", "expected a zero set, found none");
  return Rebuild(level_set, level_set.voxel_size(), half_width_voxels);
}

LevelSet Resample(const LevelSet& level_set, double new_voxel_size_world, double half_width_voxels) {
  if (!(new_voxel_size_world > 0) || !std::isfinite(new_voxel_size_world))
    throw InputError("", "voxel size", fmt::format("expected a positive length, found {}", new_voxel_size_world));
  if (level_set.empty()) throw InputError("", "level set", "expected a zero set, found none");
  return Rebuild(level_set, new_voxel_size_world, half_width_voxels);
}

}  // namespace glint
