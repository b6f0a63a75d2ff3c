// The images of a project, from files or from memory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "colmap/project.h"
#include "colmap/scene.h"
#include "core/progress.h"
#include "io/image_source.h"

namespace glint {

// Reads JPEG, PNG, TIFF, WebP, BMP and PNM with OpenCV: 8 and 16 bit, grey, CMYK and alpha become BGR; the orientation
// in EXIF is ignored, as COLMAP ignores it, so that pixels are where COLMAP's features are. Masks in COLMAP's naming:
// <masks>/<name>.png.
class ProjectImages : public ImageSource {
 public:
  // Looks which images are there; the missing are counted in one warning to `progress`. Throws InputError if there is
  // no image folder, more than half of the views' images are missing, or one is a link out of the project and its
  // folder was not named by the user.
  ProjectImages(const Scene& scene, const ProjectPaths& paths, Progress& progress = Progress::Silent());

  size_t size() const override { return views_.size(); }
  // Throws InputError naming the file: not readable as an image, a cut JPEG, values that are neither 8 nor 16 bit, a
  // size that is not the camera's.
  bool Load(size_t view, cv::Mat& image) const override;
  // Any non-zero channel is kept. A mask of another size than the camera's throws InputError.
  bool LoadMask(size_t view, cv::Mat& mask) const override;

  const std::vector<std::string>& missing() const { return missing_; }  // names
  bool has_masks() const { return num_masks_ > 0; }
  std::filesystem::path ImagePath(size_t view) const;

 private:
  struct Entry {
    std::string name;
    uint64_t width, height;
    bool has_image, has_mask;
  };
  std::filesystem::path images_, masks_;
  std::vector<Entry> views_;
  std::vector<std::string> missing_;
  size_t num_masks_ = 0;
};

// Images held in memory, for tests and rendered scenes. An empty Mat is a missing image or mask.
class MemoryImages : public ImageSource {
 public:
  explicit MemoryImages(std::vector<cv::Mat> images);
  MemoryImages(std::vector<cv::Mat> images, std::vector<cv::Mat> masks);
  ~MemoryImages() override;
  size_t size() const override;
  bool Load(size_t view, cv::Mat& image) const override;
  bool LoadMask(size_t view, cv::Mat& mask) const override;

 private:
  std::vector<cv::Mat> images_, masks_;
};

// Reads one image file as Load() does, of any size. Throws InputError.
void ReadImage(const std::filesystem::path& path, cv::Mat& image);

// Atomic; creates missing folders. CV_8U or CV_16U with 1, 3 or 4 channels (BGR). Throws InputError.
void WriteImagePng(const std::filesystem::path& path, const cv::Mat& image);
void WriteImageJpeg(const std::filesystem::path& path, const cv::Mat& image, int quality = 95);

}  // namespace glint
