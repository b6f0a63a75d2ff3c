// COLMAP's files, each alone and as a whole model with all that is made of it.
#include <array>
#include <functional>

#include "colmap/model.h"
#include "colmap/model_files.h"
#include "colmap/scene.h"
#include "tests/fuzz/scratch.h"
#include "tests/fuzz/targets.h"

namespace glint::fuzz {
namespace {

namespace fs = std::filesystem;

Model SmallModel() {
  Model model;
  model.cameras[1] = {1, CameraModel::kSimpleRadial, 640, 480, {500, 320, 240, 0.05}};
  model.cameras[2] = {2, CameraModel::kThinPrismFisheye, 800, 600, {600, 610, 400, 300, .1, -.05, 0, 0, 0, 0, 0, 0}};
  for (uint64_t p = 0; p < 3; ++p) model.points.push_back({7 + p, {0.1 * p, -0.1, 0.2}, {1, 2, 3}, 0.5, {}});
  for (uint32_t i = 0; i < 3; ++i) {
    Image& image = model.images.emplace_back();
    image.id = i + 1;
    image.name = std::string("folder/view_").append(std::to_string(i)).append(".jpg");
    image.camera_id = i % 2 + 1;
    image.cam_from_world.translation = {0.1 * i, 0, 5};
    for (uint32_t p = 0; p < model.points.size(); ++p) {
      image.points2d.push_back({{10.0 * p, 20.0 * i}, model.points[p].id});
      model.points[p].track.push_back({image.id, p});
    }
  }
  return model;
}

constexpr const char* kRigsText =
    "# rigs\n1 2 CAMERA 1 CAMERA 2 1 1 0 0 0 0.1 0 0\n2 3 IMU 4 CAMERA 2 0 CAMERA 1 1 0.9 0.1 0 0 0 0 1\n";
constexpr const char* kFramesText =
    "# frames\n1 1 1 0 0 0 0 0 5 2 CAMERA 1 1 CAMERA 2 2\n2 2 1 0 0 0 0 0 5 1 IMU 4 9\n";

template <class T>
void Put(std::string& out, T value) {
  out.append(reinterpret_cast<const char*>(&value), sizeof(value));
}
void PutPose(std::string& out) {
  for (const double value : {1.0, 0.0, 0.0, 0.0, 0.1, 0.2, 5.0}) Put(out, value);
}

std::string RigsBinary() {
  std::string out;
  Put<uint64_t>(out, 1);
  Put<uint32_t>(out, 1), Put<uint32_t>(out, 3);
  Put<int32_t>(out, 0), Put<uint32_t>(out, 1);
  Put<int32_t>(out, 0), Put<uint32_t>(out, 2), Put<uint8_t>(out, 1), PutPose(out);
  Put<int32_t>(out, 1), Put<uint32_t>(out, 4), Put<uint8_t>(out, 0);
  return out;
}

std::string FramesBinary() {
  std::string out;
  Put<uint64_t>(out, 1);
  Put<uint32_t>(out, 1), Put<uint32_t>(out, 1);
  PutPose(out);
  Put<uint32_t>(out, 2);
  Put<int32_t>(out, 0), Put<uint32_t>(out, 1), Put<uint64_t>(out, 1);
  Put<int32_t>(out, 1), Put<uint32_t>(out, 4), Put<uint64_t>(out, 9);
  return out;
}

// The five files of a model, each with the length of its text before it, so that all fit into one input.
constexpr std::array kFiles = {"cameras", "images", "points3D", "rigs", "frames"};

std::string Joined(bool is_binary, const std::array<std::string, kFiles.size()>& files) {
  std::string out(1, is_binary ? 'b' : 't');
  for (const std::string& file : files) {
    Put<uint16_t>(out, static_cast<uint16_t>(file.size()));
    out += file;
  }
  return out;
}

std::array<std::string, kFiles.size()> FilesOf(bool is_binary) {
  const fs::path folder = Scratch::Folder() / "written";
  WriteModel(SmallModel(), folder, is_binary ? ModelFormat::kBinary : ModelFormat::kText);
  std::array<std::string, kFiles.size()> files;
  for (size_t i = 0; i < 3; ++i) files[i] = BytesOf(folder / (std::string(kFiles[i]) + (is_binary ? ".bin" : ".txt")));
  files[3] = is_binary ? RigsBinary() : kRigsText;
  files[4] = is_binary ? FramesBinary() : kFramesText;
  return files;
}

std::vector<std::string> ModelSeeds() {
  std::vector<std::string> seeds;
  for (const bool is_binary : {false, true}) {
    auto files = FilesOf(is_binary);
    seeds.push_back(Joined(is_binary, files));
    files[3].clear(), files[4].clear();
    seeds.push_back(Joined(is_binary, files));
  }
  return seeds;
}

void RunModel(std::string_view bytes) {
  const fs::path folder = Scratch::Folder() / "model";
  fs::create_directories(folder);
  for (const auto& entry : fs::directory_iterator(folder)) fs::remove(entry.path());
  if (bytes.empty()) return;
  const char* extension = bytes[0] == 'b' ? ".bin" : ".txt";
  bytes.remove_prefix(1);
  for (const char* name : kFiles) {
    if (bytes.size() < 2) break;
    const size_t length = static_cast<unsigned char>(bytes[0]) + 256 * static_cast<unsigned char>(bytes[1]);
    const std::string_view file = bytes.substr(2, length);
    bytes.remove_prefix(2 + file.size());
    if (!file.empty()) ScratchFile(std::string("model/").append(name).append(extension), file);
  }
  Try([&] {
    const Scene scene = MakeScene(ReadModel(folder));
    for (const View& view : scene.views) {
      if (view.RayThrough({0.5 * static_cast<double>(view.camera.width), 1})) view.Center();
      for (const ScenePoint& point : scene.points) view.Project(point.position);
    }
  });
}

template <size_t kFile, bool kIsBinary>
std::vector<std::string> SeedsOf() {
  return {FilesOf(kIsBinary)[kFile]};
}

// Reads one file by `read(path, warnings)`.
template <auto read>
void RunBinary(std::string_view bytes) {
  internal::Warnings warnings;
  Try([&] { read(ScratchFile("file.bin", bytes), warnings); });
}
template <auto read>
void RunText(std::string_view bytes) {
  internal::Warnings warnings;
  Try([&] {
    const fs::path path = ScratchFile("file.txt", bytes);
    if constexpr (std::is_invocable_v<decltype(read), fs::path, internal::Warnings&>) {
      read(path, warnings);
    } else {
      read(path);
    }
  });
}

void RunImagesBinary(std::string_view bytes) {
  RunBinary<internal::ReadImagesBinary>(bytes);
  Try([&] { internal::ReadImageNamesBinary(ScratchFile("file.bin", bytes)); });
}
void RunImagesText(std::string_view bytes) {
  RunText<internal::ReadImagesText>(bytes);
  Try([&] { internal::ReadImageNamesText(ScratchFile("file.txt", bytes)); });
}

}  // namespace

std::vector<Target> ColmapTargets() {
  return {{"colmap_cameras_bin", RunBinary<internal::ReadCamerasBinary>, SeedsOf<0, true>},
          {"colmap_images_bin", RunImagesBinary, SeedsOf<1, true>},
          {"colmap_points_bin", RunBinary<internal::ReadPointsBinary>, SeedsOf<2, true>},
          {"colmap_rigs_bin", RunBinary<internal::ReadRigsBinary>, SeedsOf<3, true>},
          {"colmap_frames_bin", RunBinary<internal::ReadFramesBinary>, SeedsOf<4, true>},
          {"colmap_cameras_txt", RunText<internal::ReadCamerasText>, SeedsOf<0, false>},
          {"colmap_images_txt", RunImagesText, SeedsOf<1, false>},
          {"colmap_points_txt", RunText<internal::ReadPointsText>, SeedsOf<2, false>},
          {"colmap_rigs_txt", RunText<internal::ReadRigsText>, SeedsOf<3, false>},
          {"colmap_frames_txt", RunText<internal::ReadFramesText>, SeedsOf<4, false>},
          {"colmap_model", RunModel, ModelSeeds}};
}

}  // namespace glint::fuzz
