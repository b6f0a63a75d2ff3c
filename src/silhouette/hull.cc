#include "silhouette/hull.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "core/parallel.h"
#include "sdf/field_mesh.h"

namespace glint::internal {
namespace {

constexpr int kSide = 64;             // voxels across the ball
constexpr double kWrongShare = 0.25;  // of the masks, at a place
constexpr size_t kGrain = 256;

}  // namespace

TriangleMesh HullOfMost(const Scene& scene, const std::vector<ViewMask>& masks, const Reach& reach,
                        const std::optional<Eigen::Hyperplane<double, 3>>& ground) {
  const double voxel = 2 * reach.radius / kSide;
  Eigen::Affine3d world_from_index = Eigen::Affine3d::Identity();
  world_from_index.linear() *= voxel;
  world_from_index.translation() = reach.center - Eigen::Vector3d::Constant(reach.radius);
  DenseField outside;
  for (int k = 0; k < 3; ++k) outside.size[k] = kSide + 1;
  outside.values.resize(static_cast<size_t>(kSide + 1) * (kSide + 1) * (kSide + 1));
  ParallelFor(outside.values.size(), kGrain, [&](size_t i) {
    const size_t z = i % (kSide + 1), y = i / (kSide + 1) % (kSide + 1), x = i / (kSide + 1) / (kSide + 1);
    const Eigen::Vector3d at =
        world_from_index * Eigen::Vector3d(static_cast<double>(x), static_cast<double>(y), static_cast<double>(z));
    const double below = ground ? -ground->signedDistance(at) : -reach.radius;
    const double beyond = (at - reach.center).norm() - reach.radius + voxel;  // so that it is closed
    const double out = OutsideByMost(scene, masks, at, kWrongShare).value_or(reach.radius);
    outside.values[i] = static_cast<float>(std::max({out, beyond, below}));
  });
  return MeshOfField(outside, world_from_index, 0);
}

}  // namespace glint::internal
