#include "sdf/signed_distance.h"

#include <cmath>

#include "core/check.h"
#include "core/error.h"
#include "core/parallel.h"
#include "geometry/edge_topology.h"
#include "geometry/pseudo_normals.h"
#include "geometry/winding_number.h"
#include "sdf/prepared_mesh.h"
#include "sdf/sign_choice.h"

namespace glint {

struct SignedDistanceQuery::Impl {
  internal::PreparedMesh prepared;
  SdfSummary summary;
  PseudoNormals normals;
  std::unique_ptr<ClosestPointQuery> closest;
  std::unique_ptr<WindingNumber> winding;

  bool Inside(const Eigen::Vector3d& p, const MeshPoint& at) const {
    if (winding) return (*winding)(p) > 0.5;
    if (summary.sign == "unsigned") return false;
    return (p - at.point).dot(normals.Of(prepared.mesh, at)) < 0;
  }
};

SignedDistanceQuery::~SignedDistanceQuery() = default;
SignedDistanceQuery::SignedDistanceQuery(SignedDistanceQuery&&) noexcept = default;
const SdfSummary& SignedDistanceQuery::summary() const { return impl_->summary; }

SignedDistanceQuery::SignedDistanceQuery(const TriangleMesh& mesh, const std::string& sign)
    : impl_(std::make_unique<Impl>()) {
  const std::vector<std::string> violations = Violations(SdfOptions{.sign = sign});
  if (!violations.empty()) throw InputError("", "signed distance options", violations.front());
  Impl& self = *impl_;
  self.prepared = internal::PrepareMesh(mesh, Eigen::Affine3d::Identity());
  const TriangleMesh& m = self.prepared.mesh;
  self.summary.turned = self.prepared.turned;
  self.summary.degenerate_faces = self.prepared.collapsed_faces;
  self.summary.sign = sign;
  self.summary.reason = "as asked";
  if (sign == "auto") internal::ChooseSign(self.prepared, self.summary);
  if (self.summary.sign == "pseudonormal") self.normals = ComputePseudoNormals(m, BuildEdgeTopology(m));
  self.closest = std::make_unique<ClosestPointQuery>(m);
  if (self.summary.sign == "winding") self.winding = std::make_unique<WindingNumber>(m, self.closest->bvh());
}

std::optional<double> SignedDistanceQuery::Find(const Eigen::Vector3d& p, double max_distance) const {
  const auto at = impl_->closest->Find(p, max_distance);
  if (!at) return std::nullopt;
  const double distance = std::sqrt(at->squared_distance);
  return impl_->Inside(p, *at) ? -distance : distance;
}

SignedDistanceQuery::Result SignedDistanceQuery::FindClosest(const Eigen::Vector3d& p) const {
  const auto at = impl_->closest->Find(p);
  GLINT_CHECK(at.has_value());
  const TriangleMesh& m = impl_->prepared.mesh;
  const Eigen::Vector3i& face = m.faces[at->face];
  const double distance = std::sqrt(at->squared_distance);
  Result result{impl_->Inside(p, *at) ? -distance : distance, *at,
                Barycentric(m.vertices[face[0]], m.vertices[face[1]], m.vertices[face[2]], at->point)};
  internal::AsGiven(impl_->prepared, at->feature, result.closest.corner, result.barycentric);
  result.closest.face = static_cast<int>(impl_->prepared.source_face[at->face]);
  return result;
}

bool SignedDistanceQuery::Inside(const Eigen::Vector3d& p) const {
  if (impl_->winding) return (*impl_->winding)(p) > 0.5;
  return impl_->Inside(p, *impl_->closest->Find(p));
}

std::vector<double> SignedDistance(const TriangleMesh& mesh, const std::vector<Eigen::Vector3d>& points,
                                   const std::string& sign, SdfSummary* summary) {
  const SignedDistanceQuery query(mesh, sign);
  std::vector<double> distances(points.size());
  ParallelFor(points.size(), 256, [&](size_t i) { distances[i] = *query.Find(points[i]); });
  if (summary) *summary = query.summary();
  return distances;
}

}  // namespace glint
