// A COLMAP reconstruction as its files say it, and reading and writing those files.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "colmap/camera.h"
#include "geometry/rigid.h"

namespace glint {

inline constexpr uint64_t kInvalidPoint3DId = ~uint64_t{0};

struct Point2D {
  Eigen::Matrix<double, 2, 1, Eigen::DontAlign> px;  // COLMAP's pixel frame; packed, a model may hold 10⁸ of them
  uint64_t point3d_id = kInvalidPoint3DId;
};

struct Image {
  uint32_t id = 0;
  std::string name;  // path relative to the image folder, '/' separated, UTF-8
  uint32_t camera_id = 0;
  Rigid3d cam_from_world;
  std::vector<Point2D> points2d;
};

// True if all of the image's 2D points are at (0, 0): a program dropped them. The tracks hold, the pixels do not.
bool HasZeroedPoints(const Image& image);

struct TrackElement {
  uint32_t image_id;
  uint32_t point2d_index;
};

struct Point3D {
  uint64_t id = 0;
  Eigen::Vector3d xyz = Eigen::Vector3d::Zero();
  std::array<uint8_t, 3> rgb = {0, 0, 0};
  double error_px = -1;  // mean reprojection error, -1: unknown
  std::vector<TrackElement> track;
};

// Registered images only. `cameras` by id; `images` and `points` sorted by id.
struct Model {
  std::map<uint32_t, Camera> cameras;
  std::vector<Image> images;
  std::vector<Point3D> points;
  std::vector<std::string> warnings;  // what reading repaired or left out, with file and record
};

// Reads a model folder, binary (cameras.bin, ...) or text (cameras.txt, ...), COLMAP 3.x or 4.x. Where 4.x's rigs
// and frames lie beside them, the poses are theirs. Throws InputError naming file and record for what cannot be used:
// a cut file, an unknown camera model or camera id, duplicate ids or names, poses or points that are not finite, names
// that leave the image folder, no image at all, points that do not project to where the images saw them. Repairs, with
// a warning: quaternions not of unit length, tracks and 2D points that do not refer to each other (left out). An empty
// point cloud is allowed, with a warning.
Model ReadModel(const std::filesystem::path& folder);

enum class ModelFormat { kBinary, kText };

// Writes cameras, images, points3D in COLMAP 3.x's layout (read by 3.x and 4.x).
void WriteModel(const Model& model, const std::filesystem::path& folder, ModelFormat format = ModelFormat::kBinary);

}  // namespace glint
