#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "core/check.h"
#include "core/parallel.h"
#include "pipeline/page_parts.h"

namespace glint {
namespace {

constexpr int kJpegQuality = 80;

double Tenths(double x) { return std::round(x * 10) / 10; }

// Place, half axes (two standard deviations of the blob), turn of the longer one in degrees, light, status.
Json ToJson(const Highlight& h) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(h.moments_px);
  const Eigen::Vector2d major = axes.eigenvectors().col(1);
  return {Tenths(h.px.x()),
          Tenths(h.px.y()),
          Tenths(2 * std::sqrt(std::max(axes.eigenvalues()[1], 0.0))),
          Tenths(2 * std::sqrt(std::max(axes.eigenvalues()[0], 0.0))),
          std::lround(std::atan2(major.y(), major.x()) * 180 / M_PI),
          h.light,
          static_cast<int>(h.status)};
}

// Empty where there is no photograph.
std::string Jpeg(const ImageSource& images, size_t view, int max_side_px) {
  cv::Mat image;
  if (!images.Load(view, image)) return "";
  image.convertTo(image, CV_8U, image.depth() == CV_16U ? 1.0 / 257 : 1.0);
  const double scale = static_cast<double>(max_side_px) / std::max(image.cols, image.rows);
  if (scale < 1) cv::resize(image, image, {}, scale, scale, cv::INTER_AREA);
  std::vector<uchar> bytes;
  GLINT_CHECK(cv::imencode(".jpg", image, bytes, {cv::IMWRITE_JPEG_QUALITY, kJpegQuality}));
  return {bytes.begin(), bytes.end()};
}

}  // namespace

Json PagePhotos(const Scene& scene, const ImageSource& images, const std::vector<Highlight>& highlights, int max_photos,
                int max_side_px, Progress& progress) {
  const size_t num_views = scene.views.size();
  const size_t count = std::min(num_views, static_cast<size_t>(max_photos));
  std::vector<std::string> jpegs(count);
  progress.Begin("photographs for the report", count);
  ParallelFor(count, 1, [&](size_t i) {
    progress.ThrowIfCancelled();
    jpegs[i] = Base64(Jpeg(images, i * num_views / count, max_side_px));
    progress.Advance();
  });
  std::vector<Json> found(num_views, Json::array());
  for (const Highlight& h : highlights) found[h.view].push_back(ToJson(h));
  Json photos = Json::array();
  for (size_t i = 0; i < count; ++i) {
    const size_t v = i * num_views / count;
    const View& view = scene.views[v];
    photos.push_back({{"view", v},
                      {"name", view.name},
                      {"width", view.camera.width},
                      {"height", view.camera.height},
                      {"highlights", std::move(found[v])},
                      {"jpeg", std::move(jpegs[i])}});
  }
  return photos;
}

}  // namespace glint
