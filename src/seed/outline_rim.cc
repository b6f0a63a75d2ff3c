#include "seed/outline_rim.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "core/parallel.h"
#include "geometry/point_index.h"
#include "sdf/field_mesh.h"
#include "sdf/signed_distance.h"

namespace glint {
namespace {

constexpr double kMaxIntervalRel = 0.10;  // of the diagonal: a place is well known within it
constexpr int kPlacesARay = 9;
constexpr double kMissedRel = 0.01;     // outside of the mesh by this much is missed,
constexpr double kMaxMissedRel = 0.05;  // by more is something else
constexpr double kReachRel = 0.02;      // what is added lies this close to a missed place
constexpr size_t kGrain = 256;

// Where rays that the object touches come nearest to the mesh, of those that it misses.
std::vector<Eigen::Vector3d> MissedPlaces(const Scene& scene, const std::vector<OutlineSample>& outline,
                                          const TriangleMesh& mesh, double diagonal) {
  std::vector<Eigen::Vector3d> places, missed;
  for (const OutlineSample& s : outline) {
    if (s.far - s.near > kMaxIntervalRel * diagonal) continue;
    const Eigen::Vector3d eye = scene.views[s.view].Center();
    for (int k = 0; k < kPlacesARay; ++k)
      places.push_back(eye + (s.near + (s.far - s.near) * k / (kPlacesARay - 1)) * s.ray);
  }
  const std::vector<double> outside = SignedDistance(mesh, places);
  for (size_t i = 0; i < places.size(); i += kPlacesARay) {
    const auto nearest = std::min_element(outside.begin() + i, outside.begin() + i + kPlacesARay);
    if (*nearest > kMissedRel * diagonal && *nearest < kMaxMissedRel * diagonal)
      missed.push_back(places[nearest - outside.begin()]);
  }
  return missed;
}

}  // namespace

TriangleMesh MissingRim(const Scene& scene, const Silhouettes& silhouettes, const TriangleMesh& mesh, double voxel) {
  const double diagonal = Diagonal(mesh), reach = kReachRel * diagonal;
  const std::vector<Eigen::Vector3d> missed = MissedPlaces(scene, silhouettes.outline(), mesh, diagonal);
  if (missed.empty()) return {};
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& x : missed) box.extend(x);
  const double margin = 2 * reach + 2 * voxel;
  Eigen::Affine3d world_from_index = Eigen::Affine3d::Identity();
  world_from_index.linear() *= voxel;
  world_from_index.translation() = box.min() - Eigen::Vector3d::Constant(margin);
  DenseField outside;
  for (int k = 0; k < 3; ++k) outside.size[k] = static_cast<int>(std::ceil((box.sizes()[k] + 2 * margin) / voxel)) + 1;
  outside.values.resize(static_cast<size_t>(outside.size[0]) * outside.size[1] * outside.size[2]);
  const PointIndex index(missed);
  ParallelFor(outside.values.size(), kGrain, [&](size_t i) {
    const size_t z = i % outside.size[2], y = i / outside.size[2] % outside.size[1],
                 x = i / outside.size[2] / outside.size[1];
    const Eigen::Vector3d at =
        world_from_index * Eigen::Vector3d(static_cast<double>(x), static_cast<double>(y), static_cast<double>(z));
    const double beyond = (missed[index.Nearest(at, 1)[0]] - at).norm() - reach;
    outside.values[i] = static_cast<float>(beyond);
    if (beyond > reach) return;
    // Fades out away from the missed places: elsewhere the outlines leave room that the object does not fill.
    const std::optional<double> room = silhouettes.OutsideBy(at);
    if (room) outside.values[i] = static_cast<float>(*room + std::max(0.0, beyond));
  });
  return MeshOfField(outside, world_from_index, 0);
}

}  // namespace glint
