#include "colmap/camera.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "colmap/distortion.h"
#include "colmap/lens_models.h"
#include "core/check.h"

namespace glint {
namespace {

constexpr double kPi = std::numbers::pi;

enum class Family { kPerspective, kFisheye, kFov, kDivision, kEucm, kEquirectangular };

struct ModelInfo {
  std::string_view name;
  Family family;
  size_t num_focal_lengths;  // 1: f, 2: fx and fy; the principal point follows
  size_t num_params;
  std::string_view param_names;
};

// In the order of COLMAP 4.1's ids.
constexpr ModelInfo kModels[] = {
    {"SIMPLE_PINHOLE", Family::kPerspective, 1, 3, "f, cx, cy"},
    {"PINHOLE", Family::kPerspective, 2, 4, "fx, fy, cx, cy"},
    {"SIMPLE_RADIAL", Family::kPerspective, 1, 4, "f, cx, cy, k"},
    {"RADIAL", Family::kPerspective, 1, 5, "f, cx, cy, k1, k2"},
    {"OPENCV", Family::kPerspective, 2, 8, "fx, fy, cx, cy, k1, k2, p1, p2"},
    {"OPENCV_FISHEYE", Family::kFisheye, 2, 8, "fx, fy, cx, cy, k1, k2, k3, k4"},
    {"FULL_OPENCV", Family::kPerspective, 2, 12, "fx, fy, cx, cy, k1, k2, p1, p2, k3, k4, k5, k6"},
    {"FOV", Family::kFov, 2, 5, "fx, fy, cx, cy, omega"},
    {"SIMPLE_RADIAL_FISHEYE", Family::kFisheye, 1, 4, "f, cx, cy, k"},
    {"RADIAL_FISHEYE", Family::kFisheye, 1, 5, "f, cx, cy, k1, k2"},
    {"THIN_PRISM_FISHEYE", Family::kFisheye, 2, 12, "fx, fy, cx, cy, k1, k2, p1, p2, k3, k4, sx1, sy1"},
    {"RAD_TAN_THIN_PRISM_FISHEYE", Family::kFisheye, 2, 16,
     "fx, fy, cx, cy, k0, k1, k2, k3, k4, k5, p0, p1, s0, s1, s2, s3"},
    {"SIMPLE_DIVISION", Family::kDivision, 1, 4, "f, cx, cy, k"},
    {"DIVISION", Family::kDivision, 2, 5, "fx, fy, cx, cy, k"},
    {"SIMPLE_FISHEYE", Family::kFisheye, 1, 3, "f, cx, cy"},
    {"FISHEYE", Family::kFisheye, 2, 4, "fx, fy, cx, cy"},
    {"EUCM", Family::kEucm, 2, 6, "fx, fy, cx, cy, alpha, beta"},
    {"EQUIRECTANGULAR", Family::kEquirectangular, 0, 2, "w, h"},
};

const ModelInfo* FindModel(int id) {
  return id >= 0 && id < static_cast<int>(std::size(kModels)) ? &kModels[id] : nullptr;
}

const ModelInfo& Info(const Camera& camera) {
  const ModelInfo* info = FindModel(static_cast<int>(camera.model));
  GLINT_CHECK(info != nullptr);
  GLINT_CHECK_EQ(camera.params.size(), info->num_params);
  return *info;
}

Eigen::Vector2d FocalLengths(const Camera& camera, const ModelInfo& info) {
  return {camera.params[0], camera.params[info.num_focal_lengths - 1]};
}

Eigen::Vector2d PrincipalPoint(const Camera& camera, const ModelInfo& info) {
  return {camera.params[info.num_focal_lengths], camera.params[info.num_focal_lengths + 1]};
}

const double* Extra(const Camera& camera, const ModelInfo& info) {
  return camera.params.data() + info.num_focal_lengths + 2;
}

using internal::Plane;
using internal::Ray;

Plane PlaneOfPoint(const Camera& camera, const ModelInfo& info, const Eigen::Vector3d& x) {
  const double* extra = Extra(camera, info);
  const double* end = camera.params.data() + camera.params.size();
  switch (info.family) {
    case Family::kPerspective:
      if (!(x.z() > 0)) return std::nullopt;
      if (extra == end) return Eigen::Vector2d(x.head<2>() / x.z());
      return internal::Distort(internal::MakeLens(camera.model, extra), x.head<2>() / x.z());
    case Family::kFisheye: {
      const Plane plane = internal::FisheyePlane(x);
      return plane ? internal::Distort(internal::MakeLens(camera.model, extra), *plane) : std::nullopt;
    }
    case Family::kFov:
      return internal::FovPlane(extra[0], x);
    case Family::kDivision:
      return internal::DivisionPlane(extra[0], x);
    case Family::kEucm:
      return internal::EucmPlane(extra[0], extra[1], x);
    case Family::kEquirectangular:
      break;
  }
  return std::nullopt;
}

Ray RayOfPlane(const Camera& camera, const ModelInfo& info, const Eigen::Vector2d& plane) {
  const double* extra = Extra(camera, info);
  switch (info.family) {
    case Family::kPerspective:
    case Family::kFisheye: {
      const Plane undistorted = internal::Undistort(internal::MakeLens(camera.model, extra), plane);
      if (!undistorted) return std::nullopt;
      return info.family == Family::kFisheye ? internal::FisheyeRay(*undistorted) : Ray(undistorted->homogeneous());
    }
    case Family::kFov:
      return internal::FovRay(extra[0], plane);
    case Family::kDivision:
      return internal::DivisionRay(extra[0], plane);
    case Family::kEucm:
      return internal::EucmRay(extra[0], extra[1], plane);
    case Family::kEquirectangular:
      break;
  }
  return std::nullopt;
}

}  // namespace

std::optional<std::string_view> CameraModelName(int model_id) {
  const ModelInfo* info = FindModel(model_id);
  return info ? std::optional(info->name) : std::nullopt;
}

std::optional<CameraModel> CameraModelFromName(std::string_view name) {
  for (size_t id = 0; id < std::size(kModels); ++id) {
    if (kModels[id].name == name) return static_cast<CameraModel>(id);
  }
  return std::nullopt;
}

std::optional<size_t> CameraModelNumParams(int model_id) {
  const ModelInfo* info = FindModel(model_id);
  return info ? std::optional(info->num_params) : std::nullopt;
}

std::optional<std::string_view> CameraModelParamNames(int model_id) {
  const ModelInfo* info = FindModel(model_id);
  return info ? std::optional(info->param_names) : std::nullopt;
}

std::optional<std::string> CameraProblem(const Camera& camera) {
  const ModelInfo* info = FindModel(static_cast<int>(camera.model));
  if (!info) {
    return fmt::format("expected a camera model id from 0 to {}, found {}", std::size(kModels) - 1,
                       static_cast<int>(camera.model));
  }
  const auto& params = camera.params;
  if (params.size() != info->num_params) {
    return fmt::format("expected {} parameters ({}) for {}, found {}", info->num_params, info->param_names, info->name,
                       params.size());
  }
  constexpr uint64_t kMaxSize = 1'000'000, kMaxPixels = uint64_t{1} << 30;  // OpenCV reads no more
  if (camera.width < 1 || camera.height < 1 || camera.width > kMaxSize || camera.height > kMaxSize) {
    return fmt::format("expected a width and height of 1 to {} px, found {} x {}", kMaxSize, camera.width,
                       camera.height);
  }
  if (camera.width * camera.height > kMaxPixels) {
    return fmt::format("expected at most {} pixels, found {} x {}", kMaxPixels, camera.width, camera.height);
  }
  for (size_t i = 0; i < params.size(); ++i) {
    if (!std::isfinite(params[i])) {
      return fmt::format("expected finite parameters ({}), found {} as number {}", info->param_names, params[i], i + 1);
    }
  }
  const size_t num_positive = info->family == Family::kEquirectangular ? 2 : info->num_focal_lengths;
  for (size_t i = 0; i < num_positive; ++i) {
    if (!(params[i] > 0)) {
      return fmt::format("expected a positive {}, found {}", i < info->num_focal_lengths ? "focal length" : "w and h",
                         params[i]);
    }
  }
  if (info->family == Family::kFov && !(std::abs(params[4]) < kPi)) {
    return fmt::format("expected an omega between -pi and pi, found {}", params[4]);
  }
  if (info->family == Family::kEucm && !(params[4] >= 0 && params[4] <= 1 && params[5] > 0)) {
    return fmt::format("expected alpha in [0, 1] and a positive beta, found {} and {}", params[4], params[5]);
  }
  return std::nullopt;
}

std::optional<Eigen::Vector2d> ProjectToPixel(const Camera& camera, const Eigen::Vector3d& x_in_cam) {
  const ModelInfo& info = Info(camera);
  if (info.family == Family::kEquirectangular) {
    return internal::EquirectangularPixel(camera.params[0], camera.params[1], x_in_cam);
  }
  const Plane plane = PlaneOfPoint(camera, info, x_in_cam);
  if (!plane || !plane->allFinite()) return std::nullopt;
  return Eigen::Vector2d(FocalLengths(camera, info).cwiseProduct(*plane) + PrincipalPoint(camera, info));
}

std::optional<Eigen::Vector3d> BearingOfPixel(const Camera& camera, const Eigen::Vector2d& px) {
  const ModelInfo& info = Info(camera);
  if (!px.allFinite()) return std::nullopt;
  const Ray ray =
      info.family == Family::kEquirectangular
          ? internal::EquirectangularRay(camera.params[0], camera.params[1], px)
          : RayOfPlane(camera, info, (px - PrincipalPoint(camera, info)).cwiseQuotient(FocalLengths(camera, info)));
  if (!ray || !ray->allFinite()) return std::nullopt;
  return ray->normalized();
}

double MeanFocalLength(const Camera& camera) {
  const ModelInfo& info = Info(camera);
  if (info.family == Family::kEquirectangular) return 0.5 * (camera.params[0] / (2 * kPi) + camera.params[1] / kPi);
  return FocalLengths(camera, info).mean();
}

}  // namespace glint
