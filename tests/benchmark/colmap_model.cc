// Time and memory of reading a large COLMAP model.
//   colmap_model write DIR [IMAGES [POINTS]]   a sound model: each point in 5 images, as many unmatched 2D points
//   colmap_model read DIR                      seconds and peak memory
// Against COLMAP: /usr/bin/time -v colmap model_analyzer --path DIR

#include <fmt/format.h>
#include <sys/resource.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <random>
#include <string>

#include "colmap/model.h"

namespace {

using namespace glint;

Model LargeModel(size_t num_images, size_t num_points) {
  constexpr size_t kTrackLength = 5;
  Model model;
  model.cameras[1] = {1, CameraModel::kSimpleRadial, 4000, 3000, {3200, 2000, 1500, -0.02}};
  model.images.resize(num_images);
  for (size_t i = 0; i < num_images; ++i) {
    Image& image = model.images[i];
    image.id = static_cast<uint32_t>(i + 1);
    image.name = fmt::format("frames/{:06}.jpg", i);
    image.camera_id = 1;
    image.cam_from_world.rotation = Eigen::AngleAxisd(6.28 * i / num_images, Eigen::Vector3d::UnitY());
    image.cam_from_world.translation = {0, 0, 4};
    image.points2d.reserve(2 * kTrackLength * num_points / num_images + 16);
  }
  std::mt19937 random(1);
  std::uniform_real_distribution<double> place(-0.8, 0.8), pixel(0, 3000);
  model.points.resize(num_points);
  for (size_t p = 0; p < num_points; ++p) {
    Point3D& point = model.points[p];
    point.id = p + 1;
    point.xyz = {place(random), place(random), place(random)};
    point.error_px = 0.5;
    point.track.reserve(kTrackLength);
    const size_t first = p * num_images / num_points;
    for (size_t k = 0; k < kTrackLength; ++k) {
      Image& image = model.images[(first + k * 3) % num_images];
      const auto px = ProjectToPixel(model.cameras[1], image.cam_from_world * point.xyz);
      point.track.push_back({image.id, static_cast<uint32_t>(image.points2d.size())});
      image.points2d.push_back({*px, point.id});
      image.points2d.push_back({Eigen::Vector2d(pixel(random), pixel(random)), kInvalidPoint3DId});
    }
  }
  return model;
}

double PeakMegabytes() {
  rusage usage = {};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string command = argc > 2 ? argv[1] : "";
  if (command == "write") {
    const size_t num_images = argc > 3 ? std::strtoull(argv[3], nullptr, 10) : 5000;
    const size_t num_points = argc > 4 ? std::strtoull(argv[4], nullptr, 10) : 5'000'000;
    WriteModel(LargeModel(num_images, num_points), argv[2]);
    return 0;
  }
  if (command != "read") {
    fmt::print("usage: colmap_model write DIR [IMAGES [POINTS]] | read DIR\n");
    return 2;
  }
  const auto start = std::chrono::steady_clock::now();
  const Model model = ReadModel(argv[2]);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  fmt::print("{} images, {} points: {:.2f} s, peak {:.0f} MB\n", model.images.size(), model.points.size(), seconds,
             PeakMegabytes());
  for (const std::string& warning : model.warnings) fmt::print("{}\n", warning);
  return 0;
}
