#include "seed/attachment.h"

#include <cmath>

#include "core/parallel.h"
#include "geometry/closest_point.h"

namespace glint {
namespace {

constexpr size_t kGrain = 256;

}  // namespace

std::vector<AttachedPoint> AttachTo(const TriangleMesh& mesh, const std::vector<Attachment>& attachments) {
  const ClosestPointQuery query(mesh);
  std::vector<AttachedPoint> attached(attachments.size());
  ParallelFor(attached.size(), kGrain, [&](size_t i) {
    const MeshPoint at = *query.Find(attachments[i].position);
    const Eigen::Vector3i& f = mesh.faces[at.face];
    attached[i] = {f, Barycentric(mesh.vertices[f[0]], mesh.vertices[f[1]], mesh.vertices[f[2]], at.point),
                   std::sqrt(at.squared_distance)};
  });
  return attached;
}

}  // namespace glint
