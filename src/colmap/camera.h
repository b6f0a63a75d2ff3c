// COLMAP's camera models: pixel <-> bearing ray.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace glint {

// COLMAP 4.1's model ids.
enum class CameraModel : int {
  kSimplePinhole = 0,
  kPinhole = 1,
  kSimpleRadial = 2,
  kRadial = 3,
  kOpenCV = 4,
  kOpenCVFisheye = 5,
  kFullOpenCV = 6,
  kFov = 7,
  kSimpleRadialFisheye = 8,
  kRadialFisheye = 9,
  kThinPrismFisheye = 10,
  kRadTanThinPrismFisheye = 11,
  kSimpleDivision = 12,
  kDivision = 13,
  kSimpleFisheye = 14,
  kFisheye = 15,
  kEucm = 16,
  kEquirectangular = 17,
};

// Parameters in COLMAP's order. Pixels in COLMAP's frame: the centre of the first pixel is (0.5, 0.5).
// The camera looks along +z, x to the right, y down.
struct Camera {
  uint32_t id = 0;
  CameraModel model = CameraModel::kSimplePinhole;
  uint64_t width = 0;   // px
  uint64_t height = 0;  // px
  std::vector<double> params;
};

// Name as COLMAP writes it ("PINHOLE"), and the number of parameters; nullopt for an unknown id or name.
std::optional<std::string_view> CameraModelName(int model_id);
std::optional<CameraModel> CameraModelFromName(std::string_view name);
std::optional<size_t> CameraModelNumParams(int model_id);
// The parameters' names in order, as COLMAP documents them: "f, cx, cy, k".
std::optional<std::string_view> CameraModelParamNames(int model_id);

// Why the camera cannot be used (unknown model, wrong number of parameters, a value that is not finite, a focal
// length that is not positive, no size, parameters outside the model's domain); nullopt if it is sound.
std::optional<std::string> CameraProblem(const Camera& camera);

// Pixel of a point in the camera's frame; nullopt where the model cannot see it (behind a perspective camera,
// beyond the monotonic range of a distortion). Agrees with COLMAP wherever COLMAP projects in front of the camera;
// the fisheye, division and EUCM models go on behind it as far as their formula is one to one.
std::optional<Eigen::Vector2d> ProjectToPixel(const Camera& camera, const Eigen::Vector3d& x_in_cam);

// Unit bearing ray of a pixel in the camera's frame; nullopt where the distortion cannot be inverted.
std::optional<Eigen::Vector3d> BearingOfPixel(const Camera& camera, const Eigen::Vector2d& px);

// Mean focal length in pixels (params' fx, fy; for an equirectangular camera pixels a radian).
double MeanFocalLength(const Camera& camera);

}  // namespace glint
