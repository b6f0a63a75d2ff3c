#include "geometry/ray_caster.h"

#include <embree3/rtcore.h>

#include <cmath>
#include <new>

#include "core/check.h"

namespace glint {

struct RayCaster::Impl {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  double scale = 1;  // embree = (world - center) * scale
  ~Impl() {
    if (scene) rtcReleaseScene(scene);
    if (device) rtcReleaseDevice(device);
  }
};

RayCaster::RayCaster(const TriangleMesh& mesh) : impl_(std::make_unique<Impl>()) {
  Impl& self = *impl_;
  self.device = rtcNewDevice(nullptr);
  if (self.device == nullptr && rtcGetDeviceError(nullptr) == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
  GLINT_CHECK(self.device != nullptr);
  self.scene = rtcNewScene(self.device);
  rtcSetSceneFlags(self.scene, RTC_SCENE_FLAG_ROBUST);
  const double diagonal = Diagonal(mesh);
  if (!mesh.faces.empty()) {
    self.center = BoundingBox(mesh).center();
    self.scale = diagonal > 0 ? 1 / diagonal : 1;
    RTCGeometry geometry = rtcNewGeometry(self.device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                                 3 * sizeof(float), mesh.vertices.size()));
    auto* faces = static_cast<unsigned*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                                 3 * sizeof(unsigned), mesh.faces.size()));
    if (vertices == nullptr || faces == nullptr) {
      rtcReleaseGeometry(geometry);
      throw std::bad_alloc();
    }
    for (size_t v = 0; v < mesh.vertices.size(); ++v) {
      const Eigen::Vector3f x = ((mesh.vertices[v] - self.center) * self.scale).cast<float>();
      for (int k = 0; k < 3; ++k) vertices[3 * v + k] = x[k];
    }
    for (size_t f = 0; f < mesh.faces.size(); ++f)
      for (int k = 0; k < 3; ++k) faces[3 * f + k] = static_cast<unsigned>(mesh.faces[f][k]);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(self.scene, geometry);
    rtcReleaseGeometry(geometry);
  }
  rtcCommitScene(self.scene);
  const RTCError error = rtcGetDeviceError(self.device);
  if (error == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
  GLINT_CHECK_EQ(static_cast<int>(error), static_cast<int>(RTC_ERROR_NONE));
}

RayCaster::~RayCaster() = default;
RayCaster::RayCaster(RayCaster&&) noexcept = default;
RayCaster& RayCaster::operator=(RayCaster&&) noexcept = default;

std::optional<RayHit> RayCaster::Intersect(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                                           double t_min, double t_max) const {
  const Impl& self = *impl_;
  // Start next to the scene's unit sphere, so that a far camera does not cost float digits.
  const Eigen::Vector3d o = (origin - self.center) * self.scale;
  const double skip = std::max(t_min * self.scale, -o.dot(direction) - 1.0);
  const Eigen::Vector3d start = o + skip * direction;
  if (!start.allFinite() || !direction.allFinite()) return std::nullopt;
  RTCRayHit query;
  query.ray.org_x = static_cast<float>(start.x());
  query.ray.org_y = static_cast<float>(start.y());
  query.ray.org_z = static_cast<float>(start.z());
  query.ray.dir_x = static_cast<float>(direction.x());
  query.ray.dir_y = static_cast<float>(direction.y());
  query.ray.dir_z = static_cast<float>(direction.z());
  query.ray.tnear = 0;
  query.ray.tfar = static_cast<float>(std::min(1e30, t_max * self.scale - skip));
  query.ray.time = 0;
  query.ray.mask = ~0u;
  query.ray.id = 0;
  query.ray.flags = 0;
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  if (query.ray.tfar <= 0) return std::nullopt;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(self.scene, &context, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  RayHit hit;
  hit.t = (skip + query.ray.tfar) / self.scale;
  hit.position = origin + hit.t * direction;
  hit.normal = Eigen::Vector3d(query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z).normalized();
  hit.face = static_cast<int>(query.hit.primID);
  hit.u = query.hit.u;
  hit.v = query.hit.v;
  return hit;
}

bool RayCaster::Occluded(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double margin) const {
  const double length = (b - a).norm();
  if (length <= 2 * margin) return false;
  return Intersect(a, (b - a) / length, margin, length - margin).has_value();
}

}  // namespace glint
