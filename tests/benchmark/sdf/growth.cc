#include "tests/benchmark/sdf/growth.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "io/project_images.h"
#include "sdf/mesh_to_level_set.h"
#include "tests/benchmark/sdf/measure.h"
#include "tests/benchmark/sdf/meshes.h"
#include "tests/benchmark/sdf/peers.h"

namespace glint::benchmark {

namespace {

struct Sample {
  double x, glint_s, openvdb_s;
};

Sample MeasureBoth(const TriangleMesh& mesh, int resolution, double* voxels) {
  const double h = BoundingBox(mesh).sizes().maxCoeff() / resolution;
  LevelSet field;
  const Cost ours = Measure(
      3, [&] { field = MeshToLevelSet(mesh, h); }, [&] { field = LevelSet(); });
  *voxels = static_cast<double>(field.num_active_voxels());
  const Cost theirs = Measure(
      1, [&] { field = OpenVdbLevelSet(mesh, h, 3); }, [] {});
  return {0, ours.cpu_s, theirs.cpu_s};
}

void Text(cv::Mat& image, const std::string& text, double x, double y) {
  cv::putText(image, text, cv::Point(static_cast<int>(x), static_cast<int>(y)), cv::FONT_HERSHEY_SIMPLEX, 0.4,
              {60, 60, 60}, 1, cv::LINE_AA);
}

// Decades of x from 10^low_x, of seconds from a hundredth to a hundred.
cv::Mat Draw(const std::vector<Sample>& samples, int low_x, int decades, const std::string& title) {
  constexpr int kWidth = 420, kHeight = 340, kLeft = 50, kTop = 30, kPlotWidth = 350, kPlotHeight = 260;
  cv::Mat image(kHeight, kWidth, CV_8UC3, cv::Scalar(255, 255, 255));
  const auto px = [&](double x) { return kLeft + (std::log10(x) - low_x) / decades * kPlotWidth; };
  const auto py = [&](double s) { return kTop + kPlotHeight - (std::log10(s) + 2) / 4 * kPlotHeight; };
  const auto line = [&](double x0, double y0, double x1, double y1, const cv::Scalar& color, int width) {
    cv::line(image, cv::Point(static_cast<int>(x0), static_cast<int>(y0)),
             cv::Point(static_cast<int>(x1), static_cast<int>(y1)), color, width, cv::LINE_AA);
  };
  for (int d = 0; d <= decades; ++d) {
    const double x = px(std::pow(10, low_x + d));
    line(x, kTop, x, kTop + kPlotHeight, {220, 220, 220}, 1);
    Text(image, fmt::format("1e{}", low_x + d), x - 12, kTop + kPlotHeight + 16);
  }
  for (int d = -2; d <= 2; ++d) {
    const double y = py(std::pow(10, d));
    line(kLeft, y, kLeft + kPlotWidth, y, {220, 220, 220}, 1);
    Text(image, fmt::format("{:g} s", std::pow(10, d)), 4, y + 4);
  }
  const cv::Scalar blue(160, 90, 20), red(60, 60, 210);
  for (size_t i = 0; i < samples.size(); ++i) {
    for (bool ours : {true, false}) {
      const auto y = [&](const Sample& s) { return py(ours ? s.glint_s : s.openvdb_s); };
      if (i > 0) line(px(samples[i - 1].x), y(samples[i - 1]), px(samples[i].x), y(samples[i]), ours ? blue : red, 2);
    }
  }
  Text(image, title, kLeft, kTop - 12);
  if (!samples.empty()) {
    Text(image, "Glint", px(samples.back().x) + 6, py(samples.back().glint_s) + 4);
    Text(image, "OpenVDB", px(samples.back().x) + 6, py(samples.back().openvdb_s) + 4);
  }
  return image;
}

void Print(const std::string& what, const Sample& s) {
  fmt::print("{:>10} {:12.3g} {:8.3f} s {:8.3f} s  x{:.1f}\n", what, s.x, s.glint_s, s.openvdb_s,
             s.openvdb_s / s.glint_s);
  std::fflush(stdout);
}

}  // namespace

void PlotGrowth(const std::filesystem::path& png) {
  fmt::print("CPU seconds, band of 3 voxels: Glint (auto), OpenVDB\n");
  std::vector<Sample> by_triangles, by_voxels;
  double voxels = 0;
  for (const char* name : {"smooth:10000", "smooth:100000", "smooth:1000000", "smooth:3000000"}) {
    const TriangleMesh mesh = MakeMesh(name, {});
    Sample sample = MeasureBoth(mesh, 512, &voxels);
    sample.x = static_cast<double>(mesh.faces.size());
    by_triangles.push_back(sample);
    Print("triangles", sample);
  }
  const TriangleMesh mesh = MakeMesh("smooth:10000", {});
  for (int resolution : {128, 256, 512, 1024}) {
    Sample sample = MeasureBoth(mesh, resolution, &voxels);
    sample.x = voxels;
    by_voxels.push_back(sample);
    Print("voxels", sample);
  }
  cv::Mat sheet;
  cv::hconcat(std::vector<cv::Mat>{Draw(by_triangles, 4, 3, "CPU seconds by triangles, 512 voxels across"),
                                   Draw(by_voxels, 5, 3, "CPU seconds by active voxels, 10000 triangles")},
              sheet);
  WriteImagePng(png, sheet);
}

}  // namespace glint::benchmark
