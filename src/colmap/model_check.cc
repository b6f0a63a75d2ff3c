#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "colmap/model_files.h"
#include "core/error.h"

namespace glint::internal {
namespace {

// In units of the model: beyond, products of a few lengths overflow or vanish.
constexpr double kFarthest = 1e30, kSmallest = 1e-30;

std::string ImageRecord(const Image& image) { return fmt::format("image {} '{}'", image.id, image.name); }

template <class Record>
void SortById(std::vector<Record>& records, const std::filesystem::path& file, std::string_view kind) {
  const auto by_id = [](const Record& a, const Record& b) { return a.id < b.id; };
  if (!std::is_sorted(records.begin(), records.end(), by_id)) std::sort(records.begin(), records.end(), by_id);
  const auto same =
      std::adjacent_find(records.begin(), records.end(), [](const Record& a, const Record& b) { return a.id == b.id; });
  if (same != records.end()) {
    throw InputError(file.string(), fmt::format("{} {}", kind, same->id), "expected every id once, found it twice");
  }
}

bool IsUtf8(std::string_view text) {
  for (size_t i = 0; i < text.size();) {
    const auto lead = static_cast<unsigned char>(text[i++]);
    const int num_following = lead < 0x80 ? 0 : lead >> 5 == 6 ? 1 : lead >> 4 == 14 ? 2 : lead >> 3 == 30 ? 3 : -1;
    if (num_following < 0) return false;
    for (int k = 0; k < num_following; ++k, ++i) {
      if (i >= text.size() || static_cast<unsigned char>(text[i]) >> 6 != 2) return false;
    }
  }
  return true;
}

// A name must stay inside the image folder, and must be writable into a line of text.
void CheckName(const Image& image, const std::filesystem::path& file, Warnings& warnings) {
  const auto fail = [&](std::string_view what) { throw InputError(file.string(), ImageRecord(image), what); };
  if (image.name.empty()) fail("expected an image name, found none");
  for (const char c : image.name) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) fail("expected a name without control characters");
  }
  const std::filesystem::path path(image.name);
  if (path.is_absolute()) fail("expected a name relative to the image folder, found an absolute path");
  for (const auto& part : path) {
    if (part == "..") fail("expected a name inside the image folder, found '..'");
  }
  warnings.Add(
      "not UTF-8",
      [&] {
        return fmt::format("{}: image {}: its name is not UTF-8 and will look wrong in reports", file.string(),
                           image.id);
      },
      IsUtf8(image.name) ? 0 : 1);
}

std::string CameraIds(const std::map<uint32_t, Camera>& cameras) {
  std::string text;
  size_t num_listed = 0;
  for (const auto& [id, camera] : cameras) {
    if (num_listed++ == 8) return text + ", ...";
    text += (text.empty() ? "" : ", ") + std::to_string(id);
  }
  return text.empty() ? "no camera" : text;
}

void CheckImages(const ModelFiles& files, Model& model, Warnings& warnings) {
  if (model.images.empty()) {
    throw InputError(files.images.string(), "", "expected at least one registered image, found none");
  }
  SortById(model.images, files.images, "image");
  std::unordered_map<std::string_view, uint32_t> ids_by_name;
  for (const Image& image : model.images) {
    CheckName(image, files.images, warnings);
    const auto [other, is_new] = ids_by_name.emplace(image.name, image.id);
    if (!is_new) {
      throw InputError(files.images.string(), ImageRecord(image),
                       fmt::format("expected every name once, image {} has it too", other->second));
    }
    if (!model.cameras.contains(image.camera_id)) {
      throw InputError(files.images.string(), ImageRecord(image),
                       fmt::format("expected camera {} in {}, found {}: do the files belong together?", image.camera_id,
                                   files.cameras.filename().string(), CameraIds(model.cameras)));
    }
    warnings.Add(
        "2D points at zero",
        [&] {
          return fmt::format(
              "{}: {}: all {} 2D points are at (0, 0); observations are projected from the points instead",
              files.images.string(), ImageRecord(image), image.points2d.size());
        },
        HasZeroedPoints(image) ? 1 : 0);
  }
}

bool IsWithinReach(const Eigen::Vector3d& x) { return x.allFinite() && x.cwiseAbs().maxCoeff() <= kFarthest; }

void CheckPoints(const ModelFiles& files, Model& model, Warnings& warnings) {
  SortById(model.points, files.points, "point");
  Eigen::AlignedBox3d box;
  for (Point3D& point : model.points) {
    if (!IsWithinReach(point.xyz)) {
      throw InputError(files.points.string(), fmt::format("point {}", point.id),
                       fmt::format("expected a finite position within {:g} of the origin, found ({}, {}, {})",
                                   kFarthest, point.xyz.x(), point.xyz.y(), point.xyz.z()));
    }
    if (!(std::isfinite(point.error_px) && point.error_px >= 0)) point.error_px = -1;
    box.extend(point.xyz);
  }
  if (!box.isEmpty() && box.sizes().maxCoeff() > 0 && box.sizes().maxCoeff() < kSmallest)
    throw InputError(files.points.string(), "",
                     fmt::format("expected points that lie apart by more than {:g}, found {:g}: scale the model up",
                                 kSmallest, box.sizes().maxCoeff()));
  warnings.Add(
      "no points", [&] { return fmt::format("{}: the model has no 3D points", files.points.string()); },
      model.points.empty() ? 1 : 0);
}

}  // namespace

Rigid3d CheckedPose(const Eigen::Vector4d& wxyz, const Eigen::Vector3d& translation, const std::filesystem::path& file,
                    const std::string& record, Warnings& warnings) {
  constexpr double kRoundingOfLength = 1e-12, kNoteworthy = 1e-5;
  if (!wxyz.allFinite() || !IsWithinReach(translation)) {
    throw InputError(
        file.string(), record,
        fmt::format("expected a finite pose within {:g} of the origin, found the quaternion ({}, {}, {}, {}) and the "
                    "translation ({}, {}, {})",
                    kFarthest, wxyz[0], wxyz[1], wxyz[2], wxyz[3], translation.x(), translation.y(), translation.z()));
  }
  const double length = wxyz.stableNorm();
  if (!(length > 1e-9)) {
    throw InputError(file.string(), record, fmt::format("expected a unit quaternion, found one of length {}", length));
  }
  Rigid3d pose{Eigen::Quaterniond(wxyz[0], wxyz[1], wxyz[2], wxyz[3]), translation};
  if (std::abs(length - 1) > kRoundingOfLength) pose.rotation.coeffs() /= length;
  warnings.Add(
      "quaternion length",
      [&] {
        return fmt::format("{}: {}: expected a unit quaternion, found one of length {:.6g}; normalised", file.string(),
                           record, length);
      },
      std::abs(length - 1) > kNoteworthy ? 1 : 0);
  return pose;
}

Model AssembleModel(const ModelFiles& files, std::vector<Camera> cameras, std::vector<Image> images,
                    std::vector<Point3D> points, Warnings& warnings) {
  Model model;
  SortById(cameras, files.cameras, "camera");
  for (Camera& camera : cameras) {
    if (const auto problem = CameraProblem(camera)) {
      throw InputError(files.cameras.string(), fmt::format("camera {}", camera.id), *problem);
    }
    model.cameras.emplace(camera.id, std::move(camera));
  }
  model.images = std::move(images);
  CheckImages(files, model, warnings);
  model.points = std::move(points);
  CheckPoints(files, model, warnings);
  RepairTracks(files, model, warnings);
  return model;
}

void ApplyFrames(const ModelFiles& files, const std::vector<Rig>& rigs, const std::vector<Frame>& frames, Model& model,
                 Warnings& warnings) {
  std::unordered_map<uint32_t, const Rig*> rig_of_id;
  for (const Rig& rig : rigs) rig_of_id.emplace(rig.id, &rig);
  std::unordered_map<uint64_t, Rigid3d> pose_of_image;
  for (const Frame& frame : frames) {
    const auto rig = rig_of_id.find(frame.rig_id);
    if (rig == rig_of_id.end()) {
      throw InputError(files.frames.string(), fmt::format("frame {}", frame.id),
                       fmt::format("expected rig {} in {}, found none", frame.rig_id, files.rigs.filename().string()));
    }
    for (const auto& [camera_id, image_id] : frame.images) {
      std::optional<Rigid3d> camera_from_rig;
      if (rig->second->reference_camera_id == camera_id) camera_from_rig = Rigid3d();
      for (const auto& [id, pose] : rig->second->cameras) {
        if (id == camera_id && pose) camera_from_rig = pose;
      }
      // A sensor whose place on the rig is unknown leaves the image's own pose as it is.
      if (camera_from_rig) pose_of_image.insert_or_assign(image_id, *camera_from_rig * frame.rig_from_world);
    }
  }
  for (Image& image : model.images) {
    const auto found = pose_of_image.find(image.id);
    if (found == pose_of_image.end()) continue;
    const double turn = found->second.rotation.angularDistance(image.cam_from_world.rotation);
    const double shift = (found->second.translation - image.cam_from_world.translation).norm();
    if (turn <= 1e-6 && shift <= 1e-6 * (1 + image.cam_from_world.translation.norm())) continue;
    warnings.Add("frame pose", [&] {
      return fmt::format("{}: {}: the pose of its frame in {} differs ({:.3g} deg, {:.3g} units) and is used instead",
                         files.images.string(), ImageRecord(image), files.frames.filename().string(),
                         turn * 180 / 3.14159265358979, shift);
    });
    image.cam_from_world = found->second;
  }
}

}  // namespace glint::internal
