#include "io/normal_map_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <opencv2/core.hpp>
#include <optional>

#include "core/error.h"
#include "core/inside.h"
#include "io/project_images.h"

namespace glint {
namespace {

namespace fs = std::filesystem;

constexpr std::array kEndings = {".png", ".tif", ".tiff", ".geometric.bin", ".photometric.bin"};
// Lengths of what counts as a unit vector: eight bits and a resized map leave it a little off.
constexpr float kShortest = 0.7f, kLongest = 1.3f;
constexpr double kSameProportions = 0.02;
constexpr size_t kMostDigits = 6;  // of a width

bool IsColmaps(const std::string& name) { return name.ends_with(".bin"); }

std::optional<std::string> FindMap(const fs::path& folder, const std::string& image) {
  const fs::path path(image);
  for (const std::string& stem : {image, (path.parent_path() / path.stem()).string()})
    for (const char* ending : kEndings) {
      std::error_code ignored;
      if (fs::is_regular_file(folder / (stem + ending), ignored)) return stem + ending;
    }
  return std::nullopt;
}

cv::Mat FromColors(const cv::Mat& image) {
  const double white = image.depth() == CV_8U ? 255 : 65535;
  cv::Mat normals;
  image.convertTo(normals, CV_32F, 2 / white, -1);
  for (int y = 0; y < normals.rows; ++y) {
    auto* row = normals.ptr<cv::Vec3f>(y);
    for (int x = 0; x < normals.cols; ++x) row[x] = {row[x][2], row[x][1], row[x][0]};
  }
  return normals;
}

// COLMAP's: "width&height&channels&", then 32-bit floats, one channel's rows after the other's.
cv::Mat ReadColmaps(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::string head(3 * (kMostDigits + 1), '\0');
  in.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<size_t>(in.gcount()));
  std::array<int, 3> size{};
  size_t begin = 0;
  for (int& s : size) {
    const size_t end = std::min(head.find('&', begin), head.size());
    const auto [stop, fault] = std::from_chars(head.data() + begin, head.data() + end, s);
    if (end == head.size() || end > begin + kMostDigits || fault != std::errc() || stop != head.data() + end || s <= 0)
      throw InputError(file.string(), "header", "expected width&height&3& as COLMAP writes it");
    begin = end + 1;
  }
  const auto [width, height, channels] = size;
  const size_t count = static_cast<size_t>(width) * static_cast<size_t>(height);
  std::error_code error;
  const uintmax_t expected = begin + 3 * count * sizeof(float);
  const auto found = fs::file_size(file, error);
  if (channels != 3 || error || found != expected)
    throw InputError(file.string(), "",
                     fmt::format("expected {} x {} normals in {} bytes, found {} channels in {} bytes", width, height,
                                 expected, channels, found));
  in.clear();
  in.seekg(static_cast<std::streamoff>(begin));
  std::vector<float> planes(3 * count);
  if (!in.read(reinterpret_cast<char*>(planes.data()), static_cast<std::streamsize>(planes.size() * sizeof(float))))
    throw InputError(file.string(), "", "the file cannot be read");
  cv::Mat normals(height, width, CV_32FC3);
  for (size_t i = 0; i < count; ++i)
    normals.at<cv::Vec3f>(static_cast<int>(i)) = {planes[i], planes[count + i], planes[2 * count + i]};
  return normals;
}

}  // namespace

void NormalMapOptions::Visit(OptionVisitor& v) {
  v.Field({.name = "axes",
           .help = "of the maps' normals: opengl: the camera's, y up, z to the viewer; opencv: the camera's, y down, z "
                   "into the scene; world: the project's. COLMAP's own .bin maps need no word",
           .choices = {"opengl", "opencv", "world"}},
          axes);
}

NormalMapFiles::NormalMapFiles(const Scene& scene, const fs::path& folder, const NormalMapOptions& options,
                               Progress& progress)
    : folder_(folder) {
  std::error_code ignored;
  if (!fs::is_directory(folder, ignored))
    throw InputError(folder.string(), "", "expected a folder of normal maps, found none");
  size_t missing = 0;
  for (const View& view : scene.views) {
    Entry& entry = views_.emplace_back();
    entry.width = view.camera.width;
    entry.height = view.camera.height;
    entry.cam_from_map = Eigen::Matrix3d::Identity();
    const auto name = FindMap(folder, view.name);
    missing += !name;
    if (!name) continue;
    entry.name = *name;
    if (!LiesInside(folder / *name, folder))
      throw InputError((folder / *name).string(), "", "is a link that leads out of the folder of normal maps");
    if (IsColmaps(*name)) continue;
    if (options.axes == "opengl") entry.cam_from_map.diagonal() << 1, -1, -1;
    if (options.axes == "world") entry.cam_from_map = view.cam_from_world.rotation.toRotationMatrix();
  }
  if (missing == views_.size())
    throw InputError(folder.string(), "",
                     fmt::format("expected normal maps called like the photographs, {}.png for example; found none",
                                 scene.views.empty() ? "IMAGE" : scene.views.front().name));
  if (missing > 0)
    progress.Warn(fmt::format("{}: {} of {} photographs have no normal map", folder.string(), missing, views_.size()));
}

std::vector<std::string> NormalMapFiles::Names() const {
  std::vector<std::string> names;
  for (const Entry& entry : views_)
    if (!entry.name.empty()) names.push_back(entry.name);
  return names;
}

bool NormalMapFiles::LoadNormals(size_t view, cv::Mat& normals) const {
  const Entry& entry = views_.at(view);
  if (entry.name.empty()) return false;
  const fs::path file = folder_ / entry.name;
  if (IsColmaps(entry.name)) {
    normals = ReadColmaps(file);
  } else {
    cv::Mat image;
    ReadImage(file, image);
    normals = FromColors(image);
  }
  const double proportions = static_cast<double>(entry.width) / static_cast<double>(entry.height);
  if (std::abs(normals.cols / (normals.rows * proportions) - 1) > kSameProportions)
    throw InputError(file.string(), "",
                     fmt::format("expected the proportions of the camera's {} x {} pixels, found {} x {}", entry.width,
                                 entry.height, normals.cols, normals.rows));
  const Eigen::Matrix3f turn = entry.cam_from_map.cast<float>();
  for (int y = 0; y < normals.rows; ++y) {
    auto* row = normals.ptr<cv::Vec3f>(y);
    for (int x = 0; x < normals.cols; ++x) {
      Eigen::Map<Eigen::Vector3f> n(row[x].val);
      const float length = n.norm();
      if (length > kShortest && length < kLongest)
        n = (turn * n / length).eval();
      else  // NaN, too
        n.setZero();
    }
  }
  return true;
}

}  // namespace glint
