#include "pipeline/image_stages.h"

#include <algorithm>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/parallel.h"
#include "highlights/overlay.h"
#include "io/project_images.h"
#include "pipeline/workspace.h"

namespace glint {
namespace {

std::vector<std::vector<Highlight>> ByView(const std::vector<Highlight>& highlights, size_t num_views) {
  std::vector<std::vector<Highlight>> by_view(num_views);
  for (const Highlight& h : highlights) by_view.at(h.view).push_back(h);
  return by_view;
}

// Pixel coordinates are from the image's corner, so that they scale with the image.
void ScaleTo(int max_side_px, cv::Mat& image, std::vector<Highlight>& highlights) {
  const double scale = static_cast<double>(max_side_px) / std::max(image.cols, image.rows);
  if (scale >= 1) return;
  cv::Mat small;
  cv::resize(image, small, cv::Size(), scale, scale, cv::INTER_AREA);
  image = small;
  for (Highlight& h : highlights) {
    h.px *= scale;
    h.moments_px *= scale * scale;
    h.covariance_px *= scale * scale;
  }
}

}  // namespace

std::vector<Highlight> DetectInAllViews(const Scene& scene, const ImageSource& images, const DetectOptions& options,
                                        Progress& progress) {
  const size_t num_views = scene.views.size();
  std::vector<std::vector<Highlight>> by_view(num_views);
  progress.Begin("detect highlights", num_views);
  ParallelFor(num_views, 1, [&](size_t v) {
    progress.ThrowIfCancelled();
    cv::Mat image, mask;
    if (images.Load(v, image)) {
      images.LoadMask(v, mask);
      by_view[v] = DetectHighlights(image, mask, static_cast<uint32_t>(v), options);
    }
    progress.Advance();
  });
  std::vector<Highlight> all;
  for (const auto& of_view : by_view) all.insert(all.end(), of_view.begin(), of_view.end());
  return all;
}

void WriteOverlays(const Scene& scene, const ImageSource& images, const std::vector<Highlight>& highlights,
                   int max_side_px, const std::filesystem::path& folder, Progress& progress) {
  const auto by_view = ByView(highlights, scene.views.size());
  progress.Begin("draw highlights", scene.views.size());
  ParallelFor(scene.views.size(), 1, [&](size_t v) {
    progress.ThrowIfCancelled();
    cv::Mat image;
    if (images.Load(v, image)) {
      std::vector<Highlight> drawn = by_view[v];
      ScaleTo(max_side_px, image, drawn);
      WriteImagePng(PathForImage(folder, scene.views[v].name, ".png"), DrawHighlights(image, drawn));
    }
    progress.Advance();
  });
}

void WriteHighlightMasks(const Scene& scene, const std::vector<Highlight>& highlights,
                         const std::filesystem::path& folder, Progress& progress) {
  const auto by_view = ByView(highlights, scene.views.size());
  progress.Begin("write masks", scene.views.size());
  ParallelFor(scene.views.size(), 1, [&](size_t v) {
    progress.ThrowIfCancelled();
    const View& view = scene.views[v];
    WriteImagePng(PathForImage(folder, view.name, ".png"),
                  HighlightMask(static_cast<int>(view.camera.width), static_cast<int>(view.camera.height), by_view[v]));
    progress.Advance();
  });
}

}  // namespace glint
