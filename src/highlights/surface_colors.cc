#include "highlights/surface_colors.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>

#include "core/check.h"
#include "core/parallel.h"
#include "highlights/overlay.h"
#include "highlights/surface_views.h"

namespace glint {
namespace {

using Rgb = std::array<uint8_t, 3>;
constexpr size_t kGrain = 512;

// One look of a view at a vertex.
struct Look {
  uint32_t view;
  float px, py;
  Rgb rgb = {0, 0, 0};
  bool clear = false;  // an image is there, and no highlight
  bool valid = false;
};

// The views that see each vertex, the squarest `max_views` of them.
std::vector<std::vector<Look>> FindLooks(const TriangleMesh& mesh, const Scene& scene,
                                         const SurfaceColorOptions& options) {
  const SurfaceViews views(mesh, scene);
  const double min_cosine = std::cos(options.max_incidence_deg * M_PI / 180);
  std::vector<std::vector<Look>> looks(mesh.vertices.size());
  ParallelFor(mesh.vertices.size(), kGrain, [&](size_t v) {
    for (const SeenBy& seen :
         views.Squarest(mesh.vertices[v], mesh.normals[v], min_cosine, static_cast<size_t>(options.max_views)))
      looks[v].push_back({seen.view, seen.px.x(), seen.px.y()});
  });
  return looks;
}

// Between the four pixels around a place in COLMAP's frame; the image is BGR.
Rgb Sample(const cv::Mat& image, float px, float py) {
  const float x = std::clamp(px - 0.5f, 0.0f, static_cast<float>(image.cols - 1));
  const float y = std::clamp(py - 0.5f, 0.0f, static_cast<float>(image.rows - 1));
  const int x0 = std::min(static_cast<int>(x), std::max(image.cols - 2, 0)), x1 = std::min(x0 + 1, image.cols - 1);
  const int y0 = std::min(static_cast<int>(y), std::max(image.rows - 2, 0)), y1 = std::min(y0 + 1, image.rows - 1);
  const float u = x - static_cast<float>(x0), v = y - static_cast<float>(y0);
  Rgb rgb;
  for (int c = 0; c < 3; ++c) {
    const auto at = [&](int row, int column) { return static_cast<float>(image.at<cv::Vec3b>(row, column)[2 - c]); };
    const float top = (1 - u) * at(y0, x0) + u * at(y0, x1), bottom = (1 - u) * at(y1, x0) + u * at(y1, x1);
    rgb[c] = static_cast<uint8_t>(std::lround((1 - v) * top + v * bottom));
  }
  return rgb;
}

// Fills in what each image says; images are read a few at a time.
void ReadColors(const Scene& scene, const ImageSource& images, const std::vector<Highlight>& highlights,
                double margin_px, std::vector<std::vector<Look>>& looks, Progress& progress) {
  std::vector<std::vector<Look*>> of_view(scene.views.size());
  for (auto& of_vertex : looks)
    for (Look& look : of_vertex) of_view[look.view].push_back(&look);
  std::vector<std::vector<Highlight>> highlights_of(scene.views.size());
  for (const Highlight& h : highlights) highlights_of.at(h.view).push_back(h);
  progress.Begin("colours", scene.views.size());
  ParallelFor(scene.views.size(), 1, [&](size_t k) {
    progress.ThrowIfCancelled();
    cv::Mat image;
    if (!of_view[k].empty() && images.Load(k, image)) {
      if (image.depth() == CV_16U) image.convertTo(image, CV_8U, 1.0 / 257);
      const cv::Mat mask = HighlightMask(image.cols, image.rows, highlights_of[k], margin_px);
      for (Look* look : of_view[k]) {
        look->rgb = Sample(image, look->px, look->py);
        look->valid = true;
        look->clear = mask.at<uint8_t>(std::clamp(static_cast<int>(look->py), 0, mask.rows - 1),
                                       std::clamp(static_cast<int>(look->px), 0, mask.cols - 1)) != 0;
      }
    }
    progress.Advance();
  });
}

// False if no view sees the vertex.
bool MedianColor(const std::vector<Look>& looks, Rgb& rgb) {
  std::vector<Rgb> clear, all;
  for (const Look& look : looks) {
    if (look.valid) all.push_back(look.rgb);
    if (look.valid && look.clear) clear.push_back(look.rgb);
  }
  if (all.empty()) return false;
  if (clear.empty()) {
    const auto sum = [](const Rgb& c) { return c[0] + c[1] + c[2]; };
    rgb = *std::min_element(all.begin(), all.end(), [&](const Rgb& a, const Rgb& b) { return sum(a) < sum(b); });
    return true;
  }
  for (size_t c = 0; c < 3; ++c) {
    // The lower of two in the middle: gloss only adds light.
    const auto middle = clear.begin() + static_cast<std::ptrdiff_t>((clear.size() - 1) / 2);
    std::nth_element(clear.begin(), middle, clear.end(), [c](const Rgb& a, const Rgb& b) { return a[c] < b[c]; });
    rgb[c] = (*middle)[c];
  }
  return true;
}

// Colours spread from vertices that have one to their neighbours, ring by ring; what they do not reach is grey.
void SpreadColors(const TriangleMesh& mesh, std::vector<uint8_t>& known, std::vector<Rgb>& rgb) {
  constexpr Rgb kGrey = {128, 128, 128};
  for (bool grown = true; grown;) {
    grown = false;
    std::vector<std::array<uint32_t, 4>> sum(mesh.vertices.size(), {0, 0, 0, 0});  // of neighbours: red, green, blue, 1
    for (const Eigen::Vector3i& f : mesh.faces)
      for (int k = 0; k < 3; ++k)
        for (const int from : {f[(k + 1) % 3], f[(k + 2) % 3]}) {
          if (known[f[k]] || !known[from]) continue;
          for (int c = 0; c < 3; ++c) sum[f[k]][c] += rgb[from][c];
          ++sum[f[k]][3];
        }
    for (size_t v = 0; v < sum.size(); ++v) {
      if (sum[v][3] == 0) continue;
      for (int c = 0; c < 3; ++c) rgb[v][c] = static_cast<uint8_t>(sum[v][c] / sum[v][3]);
      known[v] = 1;
      grown = true;
    }
  }
  for (size_t v = 0; v < rgb.size(); ++v)
    if (!known[v]) rgb[v] = kGrey;
}

}  // namespace

SurfaceColors ColorSurface(const TriangleMesh& mesh, const Scene& scene, const ImageSource& images,
                           const std::vector<Highlight>& highlights, const SurfaceColorOptions& options,
                           Progress& progress) {
  GLINT_CHECK_EQ(mesh.normals.size(), mesh.vertices.size());
  std::vector<std::vector<Look>> looks = FindLooks(mesh, scene, options);
  progress.ThrowIfCancelled();
  ReadColors(scene, images, highlights, options.margin_px, looks, progress);
  SurfaceColors colors;
  colors.rgb.assign(mesh.vertices.size(), {0, 0, 0});
  std::vector<uint8_t> known(mesh.vertices.size());
  ParallelFor(mesh.vertices.size(), kGrain, [&](size_t v) { known[v] = MedianColor(looks[v], colors.rgb[v]); });
  colors.num_seen = static_cast<size_t>(std::count(known.begin(), known.end(), 1));
  SpreadColors(mesh, known, colors.rgb);
  return colors;
}

}  // namespace glint
