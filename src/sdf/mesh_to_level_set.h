// Exact narrow-band signed distance of a triangle mesh, with angle-weighted pseudo-normals [BA05].
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/options.h"
#include "geometry/closest_point.h"
#include "geometry/triangle_mesh.h"
#include "sdf/level_set.h"

namespace glint {

// OpenVDB refuses transforms that shrink volumes by more than about 3e-15.
inline constexpr double kSmallestVoxelWorld = 1.5e-5;

struct SdfOptions {
  double half_width_voxels = 3;
  // "pseudonormal": exact for closed, consistently oriented meshes without self-intersections. "winding": generalised
  // winding number (Barill et al. 2018), for the rest. "auto": pseudo-normals unless the mesh or the signs themselves
  // show that it is not of that kind; the summary says so. "unsigned": plain distance.
  std::string sign = "auto";
  double max_memory_gb = 0;  // 0: what the machine has free

  void Visit(OptionVisitor& v);
};

struct SdfSummary {
  std::string sign;             // the method used
  std::string reason;           // why, in words for the user
  bool turned = false;          // the mesh was inside out and has been turned
  size_t degenerate_faces = 0;  // left out: two of their corners are in one place
  size_t active_voxels = 0;
  double predicted_bytes = 0;  // of the grid and the work space
};

// What an active voxel is closest to.
struct VoxelClosest {
  Eigen::Vector3i voxel;
  uint32_t face;  // of the mesh given
  Feature feature;
  uint8_t corner;               // which edge or vertex of the face (geometry/closest_point.h); turned faces: as given
  Eigen::Vector3f barycentric;  // weights of the face's vertices, as given
};

// Voxels at integer multiples of voxel_size_world: every value with |d| < half width is exact to float rounding and
// active; inactive values are ± half width, negative inside (always positive for "unsigned"). Deterministic.
// Throws InputError if the mesh is empty or has bad vertices or indices, if the voxel size is not positive and finite,
// or if the grid would not fit in memory (the message says how much it needs). `closest`, if given, gets one entry for
// every active voxel, leaf by leaf; where faces are equally close to float rounding, any of them.
LevelSet MeshToLevelSet(const TriangleMesh& mesh, double voxel_size_world, const SdfOptions& options = {},
                        SdfSummary* summary = nullptr, std::vector<VoxelClosest>* closest = nullptr);

// The same with a transform of one's own: a rotation, a uniform scale and a translation.
LevelSet MeshToLevelSet(const TriangleMesh& mesh, const Eigen::Affine3d& world_from_index,
                        const SdfOptions& options = {}, SdfSummary* summary = nullptr,
                        std::vector<VoxelClosest>* closest = nullptr);

}  // namespace glint
