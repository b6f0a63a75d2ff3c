#include "colmap/model.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <optional>

#include "colmap/model_files.h"
#include "core/check.h"
#include "core/error.h"

namespace glint {
namespace {

namespace fs = std::filesystem;

fs::path Require(const fs::path& folder, const char* name, bool is_binary) {
  fs::path file = folder / fmt::format("{}.{}", name, is_binary ? "bin" : "txt");
  if (!fs::exists(file)) throw InputError(file.string(), "", "expected this file of the COLMAP model, found none");
  return file;
}

}  // namespace

bool HasZeroedPoints(const Image& image) {
  return image.points2d.size() > 1 && std::all_of(image.points2d.begin(), image.points2d.end(),
                                                  [](const Point2D& point) { return point.px.isZero(0); });
}

Model ReadModel(const fs::path& folder) {
  if (!fs::is_directory(folder)) throw InputError(folder.string(), "", "expected a folder with a COLMAP model");
  const auto exists = [&](const char* name) { return fs::exists(folder / name); };
  // As COLMAP does: binary where it is, else text.
  const bool is_binary = exists("images.bin") || (exists("cameras.bin") && !exists("images.txt"));
  internal::ModelFiles files;
  files.cameras = Require(folder, "cameras", is_binary);
  files.images = Require(folder, "images", is_binary);
  files.points = Require(folder, "points3D", is_binary);
  const bool has_frames =
      is_binary ? exists("rigs.bin") && exists("frames.bin") : exists("rigs.txt") && exists("frames.txt");
  if (has_frames) {
    files.rigs = Require(folder, "rigs", is_binary);
    files.frames = Require(folder, "frames", is_binary);
  }

  internal::Warnings warnings;
  auto cameras =
      is_binary ? internal::ReadCamerasBinary(files.cameras, warnings) : internal::ReadCamerasText(files.cameras);
  auto images =
      is_binary ? internal::ReadImagesBinary(files.images, warnings) : internal::ReadImagesText(files.images, warnings);
  auto points = is_binary ? internal::ReadPointsBinary(files.points, warnings) : internal::ReadPointsText(files.points);
  Model model = AssembleModel(files, std::move(cameras), std::move(images), std::move(points), warnings);
  if (has_frames) {
    const auto rigs =
        is_binary ? internal::ReadRigsBinary(files.rigs, warnings) : internal::ReadRigsText(files.rigs, warnings);
    const auto frames = is_binary ? internal::ReadFramesBinary(files.frames, warnings)
                                  : internal::ReadFramesText(files.frames, warnings);
    ApplyFrames(files, rigs, frames, model, warnings);
  }
  CheckAgreement(files, model);
  model.warnings = warnings.Take();
  return model;
}

void WriteModel(const Model& model, const fs::path& folder, ModelFormat format) {
  for (const auto& [id, camera] : model.cameras) {
    GLINT_CHECK_EQ(id, camera.id);
    GLINT_CHECK(!CameraProblem(camera));
  }
  if (format == ModelFormat::kBinary) {
    internal::WriteBinary(model, folder);
  } else {
    internal::WriteText(model, folder);
  }
}

}  // namespace glint
