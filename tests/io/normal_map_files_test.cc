#include "io/normal_map_files.h"

#include <gmock/gmock.h>

#include <bit>
#include <cmath>
#include <filesystem>
#include <opencv2/core.hpp>
#include <string>

#include "core/error.h"
#include "io/project_images.h"
#include "tests/colmap/test_model.h"

namespace glint {
namespace {

namespace fs = std::filesystem;
using testing_support::TemporaryFolder;
using testing_support::WriteFile;

constexpr int kWidth = 12, kHeight = 8;

Scene SceneOf(const std::vector<std::string>& names) {
  Scene scene;
  for (const std::string& name : names) {
    View& view = scene.views.emplace_back();
    view.name = name;
    view.camera = {1, CameraModel::kPinhole, kWidth, kHeight, {10, 10, 6, 4}};
    view.cam_from_world.rotation = Eigen::AngleAxisd(1, Eigen::Vector3d(1, 2, 3).normalized());
  }
  return scene;
}

const Eigen::Vector3d kNormal = Eigen::Vector3d(0.3, 0.5, 0.8).normalized();

void WriteMap(const fs::path& file, const Eigen::Vector3d& normal, int width = kWidth, int height = kHeight) {
  cv::Mat map(height, width, CV_16UC3);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int c = 0; c < 3; ++c)
        map.at<cv::Vec3w>(y, x)[2 - c] = static_cast<ushort>(std::lround(32767.5 * (1 + normal[c])));
  map.at<cv::Vec3w>(0, 0) = {0, 0, 0};
  WriteImagePng(file, map);
}

std::string ColmapsMap(const std::string& header, const Eigen::Vector3d& normal) {
  std::string bytes = header;
  for (int c = 0; c < 3; ++c)
    for (int i = 0; i < kWidth * kHeight; ++i) {
      const auto value = static_cast<float>(normal[c]);
      bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
    }
  return bytes;
}

Eigen::Vector3d At(const cv::Mat& map, int x, int y) {
  const auto& n = map.at<cv::Vec3f>(y, x);
  return {n[0], n[1], n[2]};
}

TEST(NormalMapFiles, EveryConventionEndsInTheCamerasAxes) {
  TemporaryFolder folder;
  const Scene scene = SceneOf({"sub/a.jpg", "b.jpg"});
  WriteMap(folder.path() / "sub" / "a.png", kNormal);
  WriteMap(folder.path() / "b.jpg.png", kNormal);
  const auto normal = [&](const std::string& axes, size_t view) {
    cv::Mat map;
    EXPECT_TRUE(NormalMapFiles(scene, folder.path(), {axes}).LoadNormals(view, map));
    EXPECT_EQ(At(map, 0, 0), Eigen::Vector3d::Zero());
    return At(map, 5, 3);
  };
  EXPECT_TRUE(normal("opencv", 0).isApprox(kNormal, 1e-4));
  EXPECT_TRUE(normal("opengl", 1).isApprox(Eigen::Vector3d(kNormal.x(), -kNormal.y(), -kNormal.z()), 1e-4));
  EXPECT_TRUE(normal("world", 0).isApprox(scene.views[0].cam_from_world.rotation * kNormal, 1e-4));
}

TEST(NormalMapFiles, ReadsColmapsOwn) {
  TemporaryFolder folder;
  WriteFile(folder.path() / "a.jpg.geometric.bin", ColmapsMap("12&8&3&", kNormal));
  cv::Mat map;
  NormalMapFiles files(SceneOf({"a.jpg", "b.jpg"}), folder.path(), {});
  ASSERT_TRUE(files.LoadNormals(0, map));
  EXPECT_TRUE(At(map, 5, 3).isApprox(kNormal, 1e-6));
  EXPECT_FALSE(files.LoadNormals(1, map));
  EXPECT_THAT(files.Names(), testing::ElementsAre("a.jpg.geometric.bin"));
}

TEST(NormalMapFiles, NamesTheFileThatIsWrong) {
  TemporaryFolder folder;
  const Scene scene = SceneOf({"a.jpg"});
  const auto message = [&](const auto& of) -> std::string {
    try {
      of();
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  const auto load = [&] {
    cv::Mat map;
    NormalMapFiles(scene, folder.path(), {}).LoadNormals(0, map);
  };
  EXPECT_THAT(message([&] { NormalMapFiles(scene, folder.path() / "none", {}); }), testing::HasSubstr("none"));
  EXPECT_THAT(message(load), testing::HasSubstr("a.jpg.png for example; found none"));
  const fs::path file = folder.path() / "a.jpg.photometric.bin";
  for (const char* header : {"", "12&8", "12&8&1&", "99999999999&8&3&", "-1&8&3&", "12x&8&3&", "12&9&3&"}) {
    WriteFile(file, ColmapsMap(header, kNormal));
    EXPECT_THAT(message(load), testing::HasSubstr("photometric.bin")) << header;
  }
  fs::remove(file);
  WriteMap(folder.path() / "a.jpg.png", kNormal, kHeight, kWidth);
  EXPECT_THAT(message(load), testing::HasSubstr("proportions"));
  WriteFile(folder.path() / "a.jpg.png", "no image");
  EXPECT_THAT(message(load), testing::HasSubstr("a.jpg.png"));
  fs::remove(folder.path() / "a.jpg.png");
  fs::create_symlink("/etc/hostname", folder.path() / "a.jpg.png");
  EXPECT_THAT(message(load), testing::HasSubstr("link"));
}

TEST(NormalMapFiles, WhatIsNoUnitVectorIsNoNormal) {
  TemporaryFolder folder;
  const float nan = std::bit_cast<float>(0x7fc00000u);
  WriteFile(folder.path() / "a.geometric.bin", ColmapsMap("12&8&3&", {nan, 0, 1}));
  cv::Mat map;
  const Scene scene = SceneOf({"a.jpg"});
  ASSERT_TRUE(NormalMapFiles(scene, folder.path(), {}).LoadNormals(0, map));
  EXPECT_EQ(At(map, 5, 3), Eigen::Vector3d::Zero());
  WriteFile(folder.path() / "a.geometric.bin", ColmapsMap("12&8&3&", {0, 0.1, 0.2}));
  ASSERT_TRUE(NormalMapFiles(scene, folder.path(), {}).LoadNormals(0, map));
  EXPECT_EQ(At(map, 5, 3), Eigen::Vector3d::Zero());
}

}  // namespace
}  // namespace glint
