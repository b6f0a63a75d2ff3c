#include "colmap/camera.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "colmap/distortion.h"
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

using Plane = std::optional<Eigen::Vector2d>;
using Ray = std::optional<Eigen::Vector3d>;  // not yet of unit length

// Equidistant plane: direction around the axis times angle from the axis.
Plane FisheyePlane(const Eigen::Vector3d& x) {
  const double across = x.head<2>().norm();
  if (across == 0) return x.z() > 0 ? Plane(Eigen::Vector2d::Zero()) : std::nullopt;
  return Eigen::Vector2d(x.head<2>() * (std::atan2(across, x.z()) / across));
}

Ray FisheyeRay(const Eigen::Vector2d& plane) {
  const double angle = plane.norm();
  if (angle >= kPi) return std::nullopt;
  const double sinc = angle < 1e-8 ? 1 : std::sin(angle) / angle;
  return Eigen::Vector3d(plane.x() * sinc, plane.y() * sinc, std::cos(angle));
}

// Devernay, Faugeras 2001: r_d = atan(2 r tan(ω/2)) / ω.
Plane FovPlane(double omega, const Eigen::Vector3d& x) {
  if (!(x.z() > 0)) return std::nullopt;
  const Eigen::Vector2d plane = x.head<2>() / x.z();
  const double r = plane.norm(), widening = 2 * std::tan(omega / 2);
  if (std::abs(omega) < 1e-9) return plane;
  if (r * std::abs(widening) < 1e-9) return Eigen::Vector2d(plane * (widening / omega));
  return Eigen::Vector2d(plane * (std::atan(r * widening) / (r * omega)));
}

Ray FovRay(double omega, const Eigen::Vector2d& plane) {
  const double r = plane.norm(), widening = 2 * std::tan(omega / 2);
  if (std::abs(omega) < 1e-9) return plane.homogeneous();
  if (r * std::abs(omega) >= kPi / 2) return std::nullopt;
  const double factor = r * std::abs(omega) < 1e-9 ? omega / widening : std::tan(r * omega) / (r * widening);
  return Eigen::Vector2d(plane * factor).homogeneous();
}

// Fitzgibbon 2001: the ray of the plane point p is (p, 1 + k |p|²).
Plane DivisionPlane(double k, const Eigen::Vector3d& x) {
  const double across2 = x.head<2>().squaredNorm(), z = x.z();
  const double discriminant = z * z - 4 * k * across2;
  if (discriminant < 0) return std::nullopt;
  const double root = std::sqrt(discriminant);
  if (z > 0) return Eigen::Vector2d(x.head<2>() * (2 / (z + root)));
  if (k >= 0 || across2 == 0) return std::nullopt;
  return Eigen::Vector2d(x.head<2>() * ((root - z) / (-2 * k * across2)));  // as above, without cancellation
}

Ray DivisionRay(double k, const Eigen::Vector2d& plane) {
  const double bend = k * plane.squaredNorm();
  if (bend >= 1) return std::nullopt;  // beyond it the angle from the axis falls again
  return Eigen::Vector3d(plane.x(), plane.y(), 1 + bend);
}

// Khomutenko, Garcia, Martinet 2016.
Plane EucmPlane(double alpha, double beta, const Eigen::Vector3d& x) {
  const double distance = std::sqrt(beta * x.head<2>().squaredNorm() + x.z() * x.z());
  const double horizon = alpha <= 0.5 ? alpha / (1 - alpha) : (1 - alpha) / alpha;
  if (!(x.z() > -horizon * distance)) return std::nullopt;
  return Eigen::Vector2d(x.head<2>() / (alpha * distance + (1 - alpha) * x.z()));
}

Ray EucmRay(double alpha, double beta, const Eigen::Vector2d& plane) {
  const double r2 = beta * plane.squaredNorm();
  const double radicand = 1 - (2 * alpha - 1) * r2;
  if (!(radicand > 0)) return std::nullopt;
  const double z = (1 - alpha * alpha * r2) / (alpha * std::sqrt(radicand) + 1 - alpha);
  return Eigen::Vector3d(plane.x(), plane.y(), z);
}

// Longitude 0 (the +z axis) at the middle column, latitude from the upper edge (-y) to the lower.
std::optional<Eigen::Vector2d> EquirectangularPixel(double width, double height, const Eigen::Vector3d& x) {
  if (x.squaredNorm() == 0) return std::nullopt;
  const double longitude = std::atan2(x.x(), x.z());
  const double latitude_down = std::atan2(x.y(), std::hypot(x.x(), x.z()));
  return Eigen::Vector2d((longitude / (2 * kPi) + 0.5) * width, (latitude_down / kPi + 0.5) * height);
}

Ray EquirectangularRay(double width, double height, const Eigen::Vector2d& px) {
  const double longitude = 2 * kPi * (px.x() / width - 0.5), latitude_down = kPi * (px.y() / height - 0.5);
  if (std::abs(latitude_down) > kPi / 2) return std::nullopt;
  const double across = std::cos(latitude_down);
  return Eigen::Vector3d(across * std::sin(longitude), std::sin(latitude_down), across * std::cos(longitude));
}

Plane PlaneOfPoint(const Camera& camera, const ModelInfo& info, const Eigen::Vector3d& x) {
  const double* extra = Extra(camera, info);
  const double* end = camera.params.data() + camera.params.size();
  switch (info.family) {
    case Family::kPerspective:
      if (!(x.z() > 0)) return std::nullopt;
      if (extra == end) return Eigen::Vector2d(x.head<2>() / x.z());
      return internal::Distort(internal::MakeLens(camera.model, extra), x.head<2>() / x.z());
    case Family::kFisheye: {
      const Plane plane = FisheyePlane(x);
      return plane ? internal::Distort(internal::MakeLens(camera.model, extra), *plane) : std::nullopt;
    }
    case Family::kFov:
      return FovPlane(extra[0], x);
    case Family::kDivision:
      return DivisionPlane(extra[0], x);
    case Family::kEucm:
      return EucmPlane(extra[0], extra[1], x);
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
      return info.family == Family::kFisheye ? FisheyeRay(*undistorted) : Ray(undistorted->homogeneous());
    }
    case Family::kFov:
      return FovRay(extra[0], plane);
    case Family::kDivision:
      return DivisionRay(extra[0], plane);
    case Family::kEucm:
      return EucmRay(extra[0], extra[1], plane);
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
  constexpr uint64_t kMaxSize = 1'000'000;
  if (camera.width < 1 || camera.height < 1 || camera.width > kMaxSize || camera.height > kMaxSize) {
    return fmt::format("expected a width and height of 1 to {} px, found {} x {}", kMaxSize, camera.width,
                       camera.height);
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
    return EquirectangularPixel(camera.params[0], camera.params[1], x_in_cam);
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
          ? EquirectangularRay(camera.params[0], camera.params[1], px)
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
