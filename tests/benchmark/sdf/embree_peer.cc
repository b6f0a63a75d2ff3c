#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>

#include "core/check.h"
#include "tests/benchmark/sdf/peers.h"

namespace glint::benchmark {

namespace {

using Eigen::Vector3d;

// Squared distance of p from the triangle abc (Ericson, Real-Time Collision Detection, 5.1.5): faster than Glint's
// routine, which also tells the feature.
double SquaredDistance(const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& p) {
  const Vector3d ab = b - a, ac = c - a, ap = p - a;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return ap.squaredNorm();
  const Vector3d bp = p - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return bp.squaredNorm();
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return (ap - d1 / (d1 - d3) * ab).squaredNorm();
  const Vector3d cp = p - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return cp.squaredNorm();
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return (ap - d2 / (d2 - d6) * ac).squaredNorm();
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0)
    return (bp - (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b)).squaredNorm();
  const double scale = 1 / (va + vb + vc);
  return (ap - vb * scale * ab - vc * scale * ac).squaredNorm();
}

class EmbreePeer : public PointPeer {
 public:
  EmbreePeer(const TriangleMesh& mesh, const PseudoNormals& normals)
      : mesh_(mesh), normals_(normals), center_(BoundingBox(mesh).center()), scale_(1 / Diagonal(mesh)) {
    device_ = rtcNewDevice(nullptr);
    GLINT_CHECK(device_ != nullptr);
    scene_ = rtcNewScene(device_);
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                                 3 * sizeof(float), mesh.vertices.size()));
    auto* faces = static_cast<unsigned*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                                 3 * sizeof(unsigned), mesh.faces.size()));
    for (size_t v = 0; v < mesh.vertices.size(); ++v)
      for (int k = 0; k < 3; ++k) vertices[3 * v + k] = static_cast<float>((mesh.vertices[v][k] - center_[k]) * scale_);
    for (size_t f = 0; f < mesh.faces.size(); ++f)
      for (int k = 0; k < 3; ++k) faces[3 * f + k] = static_cast<unsigned>(mesh.faces[f][k]);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene_);
  }
  ~EmbreePeer() override {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  std::string Name() const override { return "Embree 3 + sign"; }

  void Distances(const Vector3d* points, size_t n, double step, double reach, float* out) const override {
    Query query{this, Vector3d::Zero(), reach * reach, 0};
    RTCPointQuery embree_query;
    embree_query.time = 0;
    RTCPointQueryContext context;
    for (size_t i = 0; i < n; ++i) {
      query.p = points[i];
      // No further than from the point before, and as far as it moved.
      const double bound = i == 0 ? reach : std::min(reach, std::abs(out[i - 1]) + step);
      query.best = bound * bound * 1.00001;
      query.face = -1;
      embree_query.x = static_cast<float>((query.p[0] - center_[0]) * scale_);
      embree_query.y = static_cast<float>((query.p[1] - center_[1]) * scale_);
      embree_query.z = static_cast<float>((query.p[2] - center_[2]) * scale_);
      embree_query.radius = Radius(query.best);
      rtcInitPointQueryContext(&context);
      rtcPointQuery(scene_, &embree_query, &context, &EmbreePeer::Visit, &query);
      if (query.face < 0) {
        out[i] = static_cast<float>(reach);
        continue;
      }
      const Eigen::Vector3i& f = mesh_.faces[query.face];
      const MeshPoint at{ClosestOnTriangle(mesh_.vertices[f[0]], mesh_.vertices[f[1]], mesh_.vertices[f[2]], query.p),
                         query.face};
      const double distance = std::sqrt(at.squared_distance);
      out[i] = static_cast<float>((query.p - at.point).dot(normals_.Of(mesh_, at)) < 0 ? -distance : distance);
    }
  }

 private:
  struct Query {
    const EmbreePeer* self;
    Vector3d p;
    double best;
    int face;
  };

  // With room for the rounding of Embree's boxes.
  float Radius(double squared) const { return static_cast<float>(std::sqrt(squared) * scale_ * (1 + 1e-6) + 1e-6); }

  static bool Visit(RTCPointQueryFunctionArguments* args) {
    Query& query = *static_cast<Query*>(args->userPtr);
    const TriangleMesh& mesh = query.self->mesh_;
    const Eigen::Vector3i& f = mesh.faces[args->primID];
    const double squared = SquaredDistance(mesh.vertices[f[0]], mesh.vertices[f[1]], mesh.vertices[f[2]], query.p);
    if (!(squared < query.best)) return false;
    query.best = squared;
    query.face = static_cast<int>(args->primID);
    args->query->radius = query.self->Radius(squared);
    return true;
  }

  const TriangleMesh& mesh_;
  const PseudoNormals& normals_;
  Vector3d center_;
  double scale_;
  RTCDevice device_;
  RTCScene scene_;
};

}  // namespace

std::unique_ptr<PointPeer> MakeEmbreePeer(const TriangleMesh& mesh, const PseudoNormals& normals) {
  return std::make_unique<EmbreePeer>(mesh, normals);
}

}  // namespace glint::benchmark
