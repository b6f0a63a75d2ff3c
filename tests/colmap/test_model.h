// A small sound model and a scratch folder for the tests of colmap/ and io/.
#pragma once

#include <unistd.h>

#include <atomic>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

#include "colmap/model.h"

namespace glint::testing_support {

class TemporaryFolder {
 public:
  TemporaryFolder() {
    static std::atomic<int> counter{0};
    path_ = std::filesystem::temp_directory_path() /
            ("glint-test-" + std::to_string(::getpid()) + "-" + std::to_string(counter++));
    std::filesystem::create_directories(path_);
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

inline std::string ReadText(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

inline void WriteFile(const std::filesystem::path& path, const std::string& bytes) {
  std::filesystem::create_directories(path.parent_path());
  std::ofstream(path, std::ios::binary) << bytes;
}

// Three cameras of two models, `num_images` of them around the origin, points that every image sees.
inline Model SmallModel(int num_images = 4, int num_points = 12) {
  Model model;
  model.cameras[1] = {1, CameraModel::kSimpleRadial, 640, 480, {500, 320, 240, 0.05}};
  model.cameras[2] = {2, CameraModel::kOpenCV, 800, 600, {600, 610, 400.5, 299.5, 0.1, -0.05, 1e-3, 2e-3}};
  model.cameras[7] = {7, CameraModel::kPinhole, 640, 480, {500, 500, 320, 240}};
  const uint32_t camera_ids[] = {1, 2, 7};
  for (int p = 0; p < num_points; ++p) {
    Point3D& point = model.points.emplace_back();
    point.id = 3 + 2 * static_cast<uint64_t>(p);
    point.xyz = {0.3 * std::sin(p), 0.3 * std::cos(1.7 * p), 0.1 * std::sin(0.3 * p)};
    point.rgb = {static_cast<uint8_t>(20 * p), 7, 255};
    point.error_px = 0.1 * p;
  }
  for (int i = 0; i < num_images; ++i) {
    Image& image = model.images.emplace_back();
    image.id = static_cast<uint32_t>(i + 1);
    image.name = i == 1 ? "left side/übung 1.jpg" : "view_" + std::to_string(9 - i) + ".jpg";
    image.camera_id = camera_ids[i % 3];
    const Eigen::AngleAxisd turn(0.4 * i, Eigen::Vector3d(0.1, 1, 0.2).normalized());
    image.cam_from_world = {Eigen::Quaterniond(turn).normalized(), {0.01 * i, -0.02, 2.5}};
    image.points2d.push_back({Eigen::Vector2d(1.25, 2.5), kInvalidPoint3DId});
    for (Point3D& point : model.points) {
      const auto px = ProjectToPixel(model.cameras[image.camera_id], image.cam_from_world * point.xyz);
      if (!px) continue;
      point.track.push_back({image.id, static_cast<uint32_t>(image.points2d.size())});
      image.points2d.push_back({*px, point.id});
    }
  }
  return model;
}

}  // namespace glint::testing_support
