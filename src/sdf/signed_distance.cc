#include "sdf/signed_distance.h"

#include <fmt/format.h>

#include <cmath>

#include "core/check.h"
#include "core/error.h"
#include "core/parallel.h"
#include "geometry/clean_mesh.h"
#include "geometry/edge_topology.h"
#include "geometry/pseudo_normals.h"
#include "geometry/winding_number.h"

namespace glint {

struct SignedDistanceQuery::Impl {
  CleanMesh clean;
  SdfSummary summary;
  PseudoNormals normals;
  std::unique_ptr<ClosestPointQuery> closest;
  std::unique_ptr<WindingNumber> winding;

  bool Inside(const Eigen::Vector3d& p, const MeshPoint& at) const {
    if (winding) return (*winding)(p) > 0.5;
    if (summary.sign == "unsigned") return false;
    return (p - at.point).dot(normals.Of(clean.mesh, at)) < 0;
  }
};

SignedDistanceQuery::~SignedDistanceQuery() = default;
SignedDistanceQuery::SignedDistanceQuery(SignedDistanceQuery&&) noexcept = default;
const SdfSummary& SignedDistanceQuery::summary() const { return impl_->summary; }

SignedDistanceQuery::SignedDistanceQuery(const TriangleMesh& mesh, const std::string& sign)
    : impl_(std::make_unique<Impl>()) {
  Impl& self = *impl_;
  self.clean = Clean(mesh);
  TriangleMesh& m = self.clean.mesh;
  if (m.faces.empty()) throw InputError("", "mesh", "expected at least one triangle with three different corners");
  const EdgeTopology topology = BuildEdgeTopology(m);
  const EdgeCounts counts = CountEdges(m, topology);
  self.summary.boundary_edges = counts.boundary;
  self.summary.non_manifold_edges = counts.non_manifold;
  self.summary.misoriented_edges = counts.misoriented;
  self.summary.degenerate_faces = self.clean.collapsed_faces;
  self.summary.sign = sign;
  self.summary.reason = "as asked";
  if (sign == "auto" && counts.closed_and_oriented()) {
    self.summary.sign = "pseudonormal";
    self.summary.reason = "the mesh is closed and consistently oriented";
  } else if (sign == "auto") {
    self.summary.sign = "winding";
    self.summary.reason = fmt::format("{} boundary, {} non-manifold and {} misoriented edges", counts.boundary,
                                      counts.non_manifold, counts.misoriented);
  }
  if (self.summary.sign != "unsigned" && SignedVolume(m) < 0 && counts.misoriented == 0) {
    for (Eigen::Vector3i& face : m.faces) std::swap(face[1], face[2]);
    self.summary.turned = true;
  }
  if (self.summary.sign == "pseudonormal")
    self.normals = ComputePseudoNormals(m, self.summary.turned ? BuildEdgeTopology(m) : topology);
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
  const TriangleMesh& m = impl_->clean.mesh;
  const Eigen::Vector3i& face = m.faces[at->face];
  const double distance = std::sqrt(at->squared_distance);
  Result result{impl_->Inside(p, *at) ? -distance : distance, *at,
                Barycentric(m.vertices[face[0]], m.vertices[face[1]], m.vertices[face[2]], at->point)};
  result.closest.face = static_cast<int>(impl_->clean.source_face[at->face]);
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
