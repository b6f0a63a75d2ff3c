#include "seed/attachment.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "core/parallel.h"
#include "geometry/closest_point.h"
#include "geometry/point_index.h"

namespace glint {
namespace {

constexpr size_t kGrain = 256;
constexpr int kFacesAround = 64;  // of even triangles: a few edges far

AttachedPoint PointAt(const TriangleMesh& mesh, int face, const TrianglePoint& at) {
  const Eigen::Vector3i& f = mesh.faces[face];
  return {f, Barycentric(mesh.vertices[f[0]], mesh.vertices[f[1]], mesh.vertices[f[2]], at.point),
          std::sqrt(at.squared_distance)};
}

// Closest points on the side of the surface that faces `outward`, as far as there is one nearby.
class FacingPoints {
 public:
  explicit FacingPoints(const TriangleMesh& mesh) : mesh_(mesh), middles_(Middles(mesh)), index_(middles_) {}

  std::optional<AttachedPoint> Find(const Eigen::Vector3d& x, const Eigen::Vector3d& outward) const {
    std::optional<std::pair<TrianglePoint, int>> best;
    for (const int face : index_.Nearest(x, kFacesAround)) {
      const Eigen::Vector3i& f = mesh_.faces[face];
      const Eigen::Vector3d &a = mesh_.vertices[f[0]], &b = mesh_.vertices[f[1]], &c = mesh_.vertices[f[2]];
      if ((b - a).cross(c - a).dot(outward) <= 0) continue;
      const TrianglePoint at = ClosestOnTriangle(a, b, c, x);
      if (!best || at.squared_distance < best->first.squared_distance) best = {at, face};
    }
    if (!best) return std::nullopt;
    return PointAt(mesh_, best->second, best->first);
  }

 private:
  static std::vector<Eigen::Vector3d> Middles(const TriangleMesh& mesh) {
    std::vector<Eigen::Vector3d> middles;
    for (const Eigen::Vector3i& f : mesh.faces)
      middles.push_back((mesh.vertices[f[0]] + mesh.vertices[f[1]] + mesh.vertices[f[2]]) / 3);
    return middles;
  }

  const TriangleMesh& mesh_;
  const std::vector<Eigen::Vector3d> middles_;
  const PointIndex index_;
};

}  // namespace

std::vector<AttachedPoint> AttachTo(const TriangleMesh& mesh, const std::vector<Attachment>& attachments) {
  const ClosestPointQuery query(mesh);
  std::optional<FacingPoints> facing;
  if (std::any_of(attachments.begin(), attachments.end(), [](const Attachment& a) { return !a.outward.isZero(); }))
    facing.emplace(mesh);
  std::vector<AttachedPoint> attached(attachments.size());
  ParallelFor(attached.size(), kGrain, [&](size_t i) {
    const Attachment& a = attachments[i];
    if (!a.outward.isZero())
      if (const std::optional<AttachedPoint> point = facing->Find(a.position, a.outward)) {
        attached[i] = *point;
        return;
      }
    const MeshPoint at = *query.Find(a.position);
    attached[i] = PointAt(mesh, at.face, at);
  });
  return attached;
}

}  // namespace glint
