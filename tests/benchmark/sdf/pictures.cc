#include "tests/benchmark/sdf/pictures.h"

#include <fmt/format.h>

#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "core/parallel.h"
#include "geometry/winding_number.h"
#include "io/project_images.h"
#include "sdf/mesh_to_level_set.h"
#include "sdf/render.h"
#include "tests/geometry/test_meshes.h"
#include "tests/geometry/weighted_normals.h"

namespace glint::benchmark {

namespace {

void Label(cv::Mat& image, const std::string& text) {
  cv::putText(image, text, {10, image.rows - 12}, cv::FONT_HERSHEY_SIMPLEX, 0.5, {60, 60, 60}, 1, cv::LINE_AA);
}

cv::Mat OffsetSurfaces() {
  const TriangleMesh mesh = testing::SpikySphere(1, 0.55, 12);
  const double voxel = Diagonal(mesh) / 300;
  const double levels[] = {-0.15, 0, 0.2, 0.45};
  const LevelSet field = MeshToLevelSet(mesh, voxel, {.half_width_voxels = 0.45 / voxel + 3});
  const PictureView view = ViewOfBox({Eigen::Vector3d::Constant(-1.75), Eigen::Vector3d::Constant(1.75)},
                                     {0.5, -0.4, -1}, {0, 1, 0}, 300, 300);
  std::vector<cv::Mat> panels;
  for (double level : levels) {
    std::vector<uint8_t> pixels = RenderLevelSet(field, view, level);
    cv::Mat panel;
    cv::cvtColor(cv::Mat(view.height, view.width, CV_8UC3, pixels.data()), panel, cv::COLOR_RGB2BGR);
    Label(panel, level == 0 ? "the mesh" : fmt::format("offset {:+.2f}", level));
    panels.push_back(panel);
  }
  cv::Mat sheet;
  cv::hconcat(panels, sheet);
  return sheet;
}

// The plane y = 0 about the tip: white outside, grey inside, lines of equal distance, wrong signs red.
cv::Mat Slice(const TriangleMesh& mesh, testing::Weighting weighting, const std::string& text) {
  constexpr int kSize = 300;
  const testing::WeightedSign sign(mesh, weighting);
  const ClosestPointQuery closest(mesh);
  cv::Mat panel(kSize, kSize, CV_8UC3);
  std::vector<int> wrong(kSize, 0);
  ParallelFor(kSize, 1, [&](size_t row) {
    for (int column = 0; column < kSize; ++column) {
      const Eigen::Vector3d p(2.0 * column / kSize - 1, 1e-4, 0.8 - 2.0 * static_cast<double>(row) / kSize);
      const auto at = closest.Find(p);
      const bool inside = ExactWindingNumber(mesh, p) > 0.5;
      const bool line = std::fmod(std::sqrt(at->squared_distance), 0.1) < 0.008;
      const uint8_t shade = static_cast<uint8_t>((inside ? 190 : 255) - (line ? 50 : 0));
      cv::Vec3b color(shade, shade, shade);
      if (sign.Inside(p, *at) != inside) color = {80, 80, static_cast<uint8_t>(line ? 190 : 235)}, ++wrong[row];
      panel.at<cv::Vec3b>(static_cast<int>(row), column) = color;
    }
  });
  int total = 0;
  for (int w : wrong) total += w;
  Label(panel, fmt::format("{}: {:.1f} % wrong", text, 100.0 * total / (kSize * kSize)));
  return panel;
}

cv::Mat AngleWeights() {
  using testing::Weighting;
  cv::Mat sheet;
  cv::hconcat(std::vector<cv::Mat>{Slice(testing::Needle(1, 1), Weighting::kFace, "face normal"),
                                   Slice(testing::Needle(30, 1), Weighting::kMean, "mean normal"),
                                   Slice(testing::Needle(1, 30), Weighting::kArea, "area-weighted"),
                                   Slice(testing::Needle(30, 30), Weighting::kAngle, "angle-weighted")},
              sheet);
  return sheet;
}

}  // namespace

void WritePictures(const std::filesystem::path& folder) {
  WriteImagePng(folder / "offset_surfaces.png", OffsetSurfaces());
  WriteImagePng(folder / "angle_weights.png", AngleWeights());
}

}  // namespace glint::benchmark
