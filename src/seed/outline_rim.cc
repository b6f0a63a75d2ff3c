#include "seed/outline_rim.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "geometry/point_index.h"
#include "sdf/csg.h"
#include "sdf/field_mesh.h"
#include "sdf/signed_distance.h"
#include "seed/changed_parts.h"
#include "seed/shape.h"

namespace glint {
namespace {

constexpr double kMaxIntervalRel = 0.10;  // of the diagonal: a place is well known within it
constexpr int kPlacesARay = 9;
constexpr double kMissedRel = 0.01;                                   // outside of the mesh by this much is missed,
constexpr double kMaxMissedRel = 0.05;                                // by more is something else
constexpr std::array<double, 3> kRimReachesRel = {0.02, 0.03, 0.04};  // of the diagonal, around missed places
constexpr std::array<double, 2> kClosings = {1.5, 3};                 // voxels

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

// A rim joined to the surface. A chink between the two, or in a thin wall, may make a tunnel: as little is closed as
// leaves the fewest.
TriangleMesh Joined(const TriangleMesh& mesh, const TriangleMesh& rim, double voxel) {
  const TriangleMesh joined = Union(mesh, rim, voxel);
  TriangleMesh with = LargestPiece(joined);
  for (size_t i = 0; i < kClosings.size() && GenusOf(with) > GenusOf(mesh); ++i) {
    TriangleMesh closed = LargestPiece(Closing(joined, voxel, kClosings[i] * voxel));
    if (GenusOf(closed) < GenusOf(with)) with = std::move(closed);
  }
  return with;
}

}  // namespace

TriangleMesh MissingRim(const Scene& scene, const Silhouettes& silhouettes, const TriangleMesh& mesh, double reach,
                        double voxel) {
  const std::vector<Eigen::Vector3d> missed = MissedPlaces(scene, silhouettes.outline(), mesh, Diagonal(mesh));
  if (missed.empty()) return {};
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& x : missed) box.extend(x);
  const double margin = 2 * reach + 2 * voxel;
  Eigen::Vector3i size;
  for (int k = 0; k < 3; ++k) size[k] = static_cast<int>(std::ceil((box.sizes()[k] + 2 * margin) / voxel)) + 1;
  const PointIndex index(missed);
  return MeshOfFunction(box.min() - Eigen::Vector3d::Constant(margin), voxel, size, [&](const Eigen::Vector3d& at) {
    const double beyond = (missed[index.Nearest(at, 1)[0]] - at).norm() - reach;
    if (beyond > reach) return beyond;
    // Fades out away from the missed places: elsewhere the outlines leave room that the object does not fill.
    const std::optional<double> room = silhouettes.OutsideBy(at);
    return room ? *room + std::max(0.0, beyond) : beyond;
  });
}

TriangleMesh WithRim(const Scene& scene, const Silhouettes& silhouettes, const TriangleMesh& mesh, double voxel) {
  const double diagonal = Diagonal(mesh);
  for (const double reach : kRimReachesRel) {
    const TriangleMesh rim = MissingRim(scene, silhouettes, mesh, reach * diagonal, voxel);
    if (rim.empty()) break;
    const TriangleMesh with = Joined(mesh, rim, voxel);
    if (GenusOf(with) <= GenusOf(mesh)) return SmoothChangedParts(scene, silhouettes.outline(), mesh, with, 0);
  }
  return mesh;
}

}  // namespace glint
