#include "sdf/signed_distance.h"

#include <fmt/format.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/check.h"
#include "core/error.h"
#include "core/parallel.h"
#include "geometry/edge_topology.h"
#include "geometry/pseudo_normals.h"
#include "geometry/winding_number.h"
#include "sdf/prepared_mesh.h"
#include "sdf/sign_choice.h"

namespace glint {

namespace {

void RequireFinite(const Eigen::Vector3d& p, const std::string& name = "point") {
  if (!p.allFinite())
    throw InputError("", name, fmt::format("expected finite coordinates, found ({}, {}, {})", p[0], p[1], p[2]));
}

// The points in the order of a space-filling curve, so that one is near the one before.
std::vector<size_t> SpatialOrder(const std::vector<Eigen::Vector3d>& points) {
  Eigen::AlignedBox3d box;
  for (size_t i = 0; i < points.size(); ++i) {
    if (!points[i].allFinite()) RequireFinite(points[i], fmt::format("point {}", i));
    box.extend(points[i]);
  }
  const auto spread = [](uint64_t x) {  // two zeros after each of 16 bits
    x = (x | x << 16) & 0x0000ff0000ffull;
    x = (x | x << 8) & 0x00f00f00f00full;
    x = (x | x << 4) & 0x0c30c30c30c3ull;
    return (x | x << 2) & 0x249249249249ull;
  };
  std::vector<std::pair<uint64_t, size_t>> keyed(points.size());
  ParallelFor(points.size(), 16384, [&](size_t i) {
    uint64_t key = 0;
    for (int k = 0; k < 3; ++k) {
      const double part = (points[i][k] - box.min()[k]) / box.sizes()[k];  // NaN if the box is flat
      key |= spread(part > 0 ? static_cast<uint64_t>(std::min(part, 1.0) * 65535) : 0) << k;
    }
    keyed[i] = {key, i};
  });
  tbb::parallel_sort(keyed.begin(), keyed.end());
  std::vector<size_t> order(points.size());
  for (size_t i = 0; i < order.size(); ++i) order[i] = keyed[i].second;
  return order;
}

}  // namespace

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
  RequireFinite(p);
  const auto at = impl_->closest->Find(p, max_distance);
  if (!at) return std::nullopt;
  const double distance = std::sqrt(at->squared_distance);
  return impl_->Inside(p, *at) ? -distance : distance;
}

SignedDistanceQuery::Result SignedDistanceQuery::FindClosest(const Eigen::Vector3d& p) const {
  RequireFinite(p);
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

std::vector<double> SignedDistanceQuery::Distances(const std::vector<Eigen::Vector3d>& points) const {
  std::vector<double> distances(points.size());
  const std::vector<size_t> order = SpatialOrder(points);
  ParallelChunks(points.size(), 512, [&](size_t begin, size_t end) {
    int near_face = -1;
    for (size_t i = begin; i < end; ++i) {
      const Eigen::Vector3d& p = points[order[i]];
      const MeshPoint at = *impl_->closest->Find(p, std::numeric_limits<double>::infinity(), near_face);
      const double distance = std::sqrt(at.squared_distance);
      distances[order[i]] = impl_->Inside(p, at) ? -distance : distance;
      near_face = at.face;
    }
  });
  return distances;
}

bool SignedDistanceQuery::Inside(const Eigen::Vector3d& p) const {
  RequireFinite(p);
  if (impl_->winding) return (*impl_->winding)(p) > 0.5;
  return impl_->Inside(p, *impl_->closest->Find(p));
}

std::vector<double> SignedDistance(const TriangleMesh& mesh, const std::vector<Eigen::Vector3d>& points,
                                   const std::string& sign, SdfSummary* summary) {
  const SignedDistanceQuery query(mesh, sign);
  if (summary) *summary = query.summary();
  return query.Distances(points);
}

}  // namespace glint
