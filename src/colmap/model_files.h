// The single files of a COLMAP model, as they are, without a look at what they mean together. Internal to colmap/.
// All readers throw InputError naming file and record; all writers write atomically.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "colmap/model.h"
#include "colmap/warnings.h"

namespace glint::internal {

// COLMAP 4.x: cameras that are mounted together. Sensors that are no cameras are left out.
struct Rig {
  uint32_t id = 0;
  std::optional<uint32_t> reference_camera_id;                       // sits at the rig's origin
  std::vector<std::pair<uint32_t, std::optional<Rigid3d>>> cameras;  // camera id, camera_from_rig if known
};

// COLMAP 4.x: the images that a rig took at one instant.
struct Frame {
  uint32_t id = 0;
  uint32_t rig_id = 0;
  Rigid3d rig_from_world;
  std::vector<std::pair<uint32_t, uint64_t>> images;  // camera id, image id
};

std::vector<Camera> ReadCamerasBinary(const std::filesystem::path& file, Warnings& warnings);
std::vector<Image> ReadImagesBinary(const std::filesystem::path& file, Warnings& warnings);
std::vector<Point3D> ReadPointsBinary(const std::filesystem::path& file, Warnings& warnings);
std::vector<Rig> ReadRigsBinary(const std::filesystem::path& file, Warnings& warnings);
std::vector<Frame> ReadFramesBinary(const std::filesystem::path& file, Warnings& warnings);

std::vector<Camera> ReadCamerasText(const std::filesystem::path& file);
std::vector<Image> ReadImagesText(const std::filesystem::path& file, Warnings& warnings);
std::vector<Point3D> ReadPointsText(const std::filesystem::path& file);
std::vector<Rig> ReadRigsText(const std::filesystem::path& file, Warnings& warnings);
std::vector<Frame> ReadFramesText(const std::filesystem::path& file, Warnings& warnings);

// The names of all images, without their points.
std::vector<std::string> ReadImageNamesBinary(const std::filesystem::path& file);
std::vector<std::string> ReadImageNamesText(const std::filesystem::path& file);

void WriteBinary(const Model& model, const std::filesystem::path& folder);
void WriteText(const Model& model, const std::filesystem::path& folder);

// What the files mean together. Sorts, checks, repairs with a warning or throws InputError; see ReadModel.
struct ModelFiles {
  std::filesystem::path cameras, images, points, rigs, frames;  // rigs and frames: empty if there are none
};
Model AssembleModel(const ModelFiles& files, std::vector<Camera> cameras, std::vector<Image> images,
                    std::vector<Point3D> points, Warnings& warnings);

// Replaces the images' poses by those of their rigs and frames, as COLMAP 4.x does.
void ApplyFrames(const ModelFiles& files, const std::vector<Rig>& rigs, const std::vector<Frame>& frames, Model& model,
                 Warnings& warnings);

// Drops track elements and 2D points that do not refer to each other. The model is sorted by id.
void RepairTracks(const ModelFiles& files, Model& model, Warnings& warnings);

// Throws InputError if the points do not project to where the images say they saw them (camera-to-world poses, files
// of two models), judged by the median over a sample of the observations.
void CheckAgreement(const ModelFiles& files, const Model& model);

// A pose as the files say it: throws InputError if it is not finite or has no rotation; normalises the quaternion.
Rigid3d CheckedPose(const Eigen::Vector4d& quaternion_wxyz, const Eigen::Vector3d& translation,
                    const std::filesystem::path& file, const std::string& record, Warnings& warnings);

}  // namespace glint::internal
