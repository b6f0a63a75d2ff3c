#include "silhouette/hull.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "sdf/field_mesh.h"

namespace glint::internal {
namespace {

constexpr int kSide = 64;             // voxels across the ball
constexpr double kWrongShare = 0.25;  // of the masks, at a place

}  // namespace

TriangleMesh HullOfMost(const Scene& scene, const std::vector<ViewMask>& masks, const Reach& reach,
                        const std::optional<Eigen::Hyperplane<double, 3>>& ground) {
  const double voxel = 2 * reach.radius / kSide;
  const Eigen::Vector3d corner = reach.center - Eigen::Vector3d::Constant(reach.radius);
  return MeshOfFunction(corner, voxel, Eigen::Vector3i::Constant(kSide + 1), [&](const Eigen::Vector3d& at) {
    const double below = ground ? -ground->signedDistance(at) : -reach.radius;
    const double beyond = (at - reach.center).norm() - reach.radius + voxel;  // so that it is closed
    const double out = OutsideByMost(scene, masks, at, kWrongShare).value_or(reach.radius);
    return std::max({out, beyond, below});
  });
}

}  // namespace glint::internal
