// Photographs and masks through the path that projects are read by.
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "io/image_header.h"
#include "io/normal_map_files.h"
#include "io/project_images.h"
#include "tests/fuzz/scratch.h"
#include "tests/fuzz/targets.h"

namespace glint::fuzz {
namespace {

constexpr int kWidth = 24, kHeight = 16;

std::string Encoded(const char* extension, int type, const std::vector<int>& options = {}) {
  cv::Mat image(kHeight, kWidth, type);
  for (int y = 0; y < kHeight; ++y) {
    for (size_t x = 0; x < kWidth * image.elemSize(); ++x) image.ptr(y)[x] = static_cast<uchar>(7 * x + 13 * y);
  }
  std::vector<uchar> bytes;
  cv::imencode(extension, image, bytes, options);
  return {bytes.begin(), bytes.end()};
}

std::vector<std::string> Seeds() {
  return {Encoded(".jpg", CV_8UC3),  Encoded(".jpg", CV_8UC1, {cv::IMWRITE_JPEG_PROGRESSIVE, 1}),
          Encoded(".png", CV_8UC3),  Encoded(".png", CV_16UC1),
          Encoded(".png", CV_8UC4),  Encoded(".bmp", CV_8UC3),
          Encoded(".tif", CV_16UC3), Encoded(".webp", CV_8UC3),
          Encoded(".ppm", CV_8UC3)};
}

void RunHeader(std::string_view bytes) { ReadImageHeader(bytes); }

// As a photograph and as a mask of a project whose camera says the size of the seeds.
void RunProject(std::string_view bytes) {
  ScratchFile("images/a.jpg", bytes);
  ScratchFile("masks/a.jpg.png", bytes);
  Scene scene;
  View& view = scene.views.emplace_back();
  view.name = "a.jpg";
  view.camera = {1, CameraModel::kPinhole, kWidth, kHeight, {10, 10, 6, 4}};
  ProjectPaths paths;
  paths.root = Scratch::Folder();
  paths.images = paths.root / "images";
  paths.masks = paths.root / "masks";
  Try([&] {
    const ProjectImages images(scene, paths);
    cv::Mat image, mask;
    Try([&] { images.Load(0, image); });
    Try([&] { images.LoadMask(0, mask); });
  });
}

void RunFree(std::string_view bytes) {
  cv::Mat image;
  Try([&] { ReadImage(ScratchFile("ball.jpg", bytes), image); });
}

std::vector<std::string> NormalMapSeeds() {
  std::string colmaps = std::to_string(kWidth) + "&" + std::to_string(kHeight) + "&3&";
  for (const float value : {0.6F, 0.0F, -0.8F})
    for (int i = 0; i < kWidth * kHeight; ++i) colmaps.append(reinterpret_cast<const char*>(&value), sizeof(value));
  return {colmaps, Encoded(".png", CV_16UC3), Encoded(".png", CV_8UC3)};
}

// As an image and as a map of COLMAP's.
void RunNormalMap(std::string_view bytes) {
  ScratchFile("maps/a.jpg.png", bytes);
  ScratchFile("maps/b.jpg.geometric.bin", bytes);
  Scene scene;
  for (const char* name : {"a.jpg", "b.jpg"}) {
    View& view = scene.views.emplace_back();
    view.name = name;
    view.camera = {1, CameraModel::kPinhole, kWidth, kHeight, {10, 10, 6, 4}};
  }
  Try([&] {
    const NormalMapFiles maps(scene, Scratch::Folder() / "maps", {});
    cv::Mat map;
    for (const size_t view : {0, 1}) Try([&] { maps.LoadNormals(view, map); });
  });
}

}  // namespace

std::vector<Target> ImageTargets() {
  return {{"image_header", RunHeader, Seeds},
          {"project_image", RunProject, Seeds},
          {"free_image", RunFree, Seeds},
          {"normal_map", RunNormalMap, NormalMapSeeds}};
}

}  // namespace glint::fuzz
