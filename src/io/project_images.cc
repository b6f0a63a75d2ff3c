#include "io/project_images.h"

#include <fmt/format.h>

#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "core/atomic_file.h"
#include "core/check.h"
#include "core/error.h"
#include "core/inside.h"
#include "io/image_header.h"
#include "io/jpeg_check.h"

namespace glint {
namespace {

namespace fs = std::filesystem;

std::vector<uchar> ReadBytes(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::error_code error;
  std::vector<uchar> bytes(in ? fs::file_size(path, error) : 0);
  if (!in || error || !in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()))) {
    throw InputError(path.string(), "", "expected an image, the file cannot be read");
  }
  if (bytes.empty()) throw InputError(path.string(), "", "expected an image, found an empty file");
  return bytes;
}

struct Size {
  uint64_t width, height;
};

void CheckSize(const fs::path& path, const Size& expected, const Size& found) {
  if (found.width == expected.width && found.height == expected.height) return;
  const bool swapped = found.width == expected.height && found.height == expected.width;
  throw InputError(
      path.string(), "",
      fmt::format("expected {} x {} pixels as the camera says, found {} x {}{}", expected.width, expected.height,
                  found.width, found.height, swapped ? ": was the image turned after COLMAP had seen it?" : ""));
}

// Before a decoder allocates what the file says it is.
void CheckHeader(const fs::path& path, std::string_view bytes, const std::optional<Size>& expected) {
  const auto header = ReadImageHeader(bytes);
  if (!header && internal::IsJpeg(reinterpret_cast<const uchar*>(bytes.data()), bytes.size()))
    throw InputError(path.string(), "", fmt::format("expected a whole JPEG of {} bytes: no size in it", bytes.size()));
  if (!header)
    throw InputError(path.string(), "",
                     "expected an image (JPEG, PNG, TIFF, WebP, BMP or PNM), found something that cannot be decoded");
  if (ClaimsTooMuch(*header, bytes.size()))
    throw InputError(path.string(), "",
                     fmt::format("expected an image, found a {} that claims {} x {} pixels in {} bytes", header->format,
                                 header->width, header->height, bytes.size()));
  if (expected) CheckSize(path, *expected, {header->width, header->height});
}

cv::Mat Decode(const fs::path& path, int flags, const std::optional<Size>& expected = std::nullopt) {
  const std::vector<uchar> bytes = ReadBytes(path);
  CheckHeader(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()}, expected);
  // OpenCV fills what a cut or damaged JPEG lacks with grey and says nothing to us.
  if (internal::IsJpeg(bytes.data(), bytes.size())) {
    if (const auto damage = internal::JpegDamage(bytes.data(), bytes.size())) {
      throw InputError(path.string(), "", fmt::format("expected a whole JPEG of {} bytes: {}", bytes.size(), *damage));
    }
  }
  cv::Mat image;
  try {
    image = cv::imdecode(bytes, flags | cv::IMREAD_IGNORE_ORIENTATION);
  } catch (const cv::Exception& exception) {
    throw InputError(path.string(), "", fmt::format("expected an image: {}", exception.err));
  }
  if (image.empty()) throw InputError(path.string(), "", "expected an image, found something that cannot be decoded");
  if (image.depth() != CV_8U && image.depth() != CV_16U) {
    throw InputError(path.string(), "", "expected 8 or 16 bits a channel, found floating-point values");
  }
  if (expected) CheckSize(path, *expected, {static_cast<uint64_t>(image.cols), static_cast<uint64_t>(image.rows)});
  return image;
}

bool IsFile(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored);
}

// A project may come from elsewhere: a link in it must not lead to the user's own files unless he named its folder.
bool IsUsable(const fs::path& file, const fs::path& folder, const fs::path& root, bool is_given, const char* option) {
  if (!IsFile(file)) return false;
  if (is_given || LiesInside(file, folder) || LiesInside(file, root)) return true;
  throw InputError(
      file.string(), "",
      fmt::format("is a link that leads out of the project; {} {} follows it all the same", option, folder.string()));
}

void WriteEncoded(const fs::path& path, const cv::Mat& image, const char* extension, const std::vector<int>& options) {
  GLINT_CHECK(!image.empty());
  std::vector<uchar> bytes;
  GLINT_CHECK(cv::imencode(extension, image, bytes, options));
  WriteFileAtomically(path, std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

}  // namespace

ProjectImages::ProjectImages(const Scene& scene, const ProjectPaths& paths, Progress& progress)
    : images_(paths.images), masks_(paths.masks) {
  if (images_.empty()) {
    throw InputError(paths.root.string(), "",
                     "expected a folder with the project's images, found none (--images names it)");
  }
  for (const View& view : scene.views) {
    Entry& entry = views_.emplace_back();
    entry.name = view.name;
    entry.width = view.camera.width;
    entry.height = view.camera.height;
    entry.has_image = IsUsable(images_ / view.name, images_, paths.root, paths.images_given, "--images");
    entry.has_mask =
        !masks_.empty() && IsUsable(masks_ / (view.name + ".png"), masks_, paths.root, paths.masks_given, "--masks");
    if (!entry.has_image) missing_.push_back(view.name);
    num_masks_ += entry.has_mask ? 1 : 0;
  }
  if (2 * missing_.size() > views_.size()) {
    throw InputError(images_.string(), "",
                     fmt::format("expected the images of {} views, {} are missing, for example {}", views_.size(),
                                 missing_.size(), missing_.front()));
  }
  if (!missing_.empty()) {
    progress.Warn(fmt::format("{}: {} of {} images are missing and left out, for example {}", images_.string(),
                              missing_.size(), views_.size(), missing_.front()));
  }
  if (!masks_.empty() && num_masks_ < views_.size()) {
    progress.Warn(fmt::format("{}: {} of {} views have no mask called <image name>.png", masks_.string(),
                              views_.size() - num_masks_, views_.size()));
  }
}

fs::path ProjectImages::ImagePath(size_t view) const { return images_ / views_.at(view).name; }

bool ProjectImages::Load(size_t view, cv::Mat& image) const {
  const Entry& entry = views_.at(view);
  if (!entry.has_image) return false;
  image = Decode(ImagePath(view), cv::IMREAD_COLOR | cv::IMREAD_ANYDEPTH, Size{entry.width, entry.height});
  return true;
}

bool ProjectImages::LoadMask(size_t view, cv::Mat& mask) const {
  const Entry& entry = views_.at(view);
  if (!entry.has_mask) return false;
  const fs::path path = masks_ / (entry.name + ".png");
  mask = Decode(path, cv::IMREAD_GRAYSCALE, Size{entry.width, entry.height});
  return true;
}

MemoryImages::MemoryImages(std::vector<cv::Mat> images) : images_(std::move(images)) {}

MemoryImages::MemoryImages(std::vector<cv::Mat> images, std::vector<cv::Mat> masks)
    : images_(std::move(images)), masks_(std::move(masks)) {
  GLINT_CHECK(masks_.empty() || masks_.size() == images_.size());
}

MemoryImages::~MemoryImages() = default;

size_t MemoryImages::size() const { return images_.size(); }

bool MemoryImages::Load(size_t view, cv::Mat& image) const {
  if (images_.at(view).empty()) return false;
  image = images_[view];
  return true;
}

bool MemoryImages::LoadMask(size_t view, cv::Mat& mask) const {
  if (masks_.empty() || masks_.at(view).empty()) return false;
  mask = masks_[view];
  return true;
}

void ReadImage(const fs::path& path, cv::Mat& image) { image = Decode(path, cv::IMREAD_COLOR | cv::IMREAD_ANYDEPTH); }

void WriteImagePng(const fs::path& path, const cv::Mat& image) {
  GLINT_CHECK(image.depth() == CV_8U || image.depth() == CV_16U);
  WriteEncoded(path, image, ".png", {cv::IMWRITE_PNG_COMPRESSION, 4});
}

void WriteImageJpeg(const fs::path& path, const cv::Mat& image, int quality) {
  GLINT_CHECK_EQ(image.depth(), CV_8U);
  WriteEncoded(path, image, ".jpg", {cv::IMWRITE_JPEG_QUALITY, quality});
}

}  // namespace glint
