#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "geometry/render_mesh.h"
#include "pipeline/error_map.h"

namespace glint {
namespace {

constexpr int kPanelWidth = 300, kPanelHeight = 250;  // px, of one side
constexpr double kFilled = 0.92;                      // of the panel, by the surface
constexpr int kPlotWidth = 440;
constexpr int kTitleHeight = 28;
constexpr int kMargin = 16;
constexpr int kScaleHeight = 10;
const cv::Scalar kInk(60, 60, 60), kFaint(205, 205, 205);

// Of the directions to the corners of a tetrahedron: every place of a convex surface turns towards one of them.
const Eigen::Vector3d kDirections[] = {{-1, -1, -1}, {1, -1, 1}, {-1, 1, 1}, {1, 1, -1}};

void PutText(cv::Mat& sheet, int x, int y, const std::string& text, double size = 0.45) {
  cv::putText(sheet, text, {x, y}, cv::FONT_HERSHEY_SIMPLEX, size, kInk, 1, cv::LINE_AA);
}

cv::Scalar Bgr(const std::array<uint8_t, 3>& rgb) { return cv::Scalar(rgb[2], rgb[1], rgb[0]); }

cv::Mat Panel(const TriangleMesh& mesh, const Eigen::Vector3d& direction) {
  PictureView view =
      ViewOfBox(BoundingBox(mesh), direction.normalized(), Eigen::Vector3d::UnitY(), kPanelWidth, kPanelHeight);
  double reach = 1e-9;  // half the picture's size, of what lies furthest from its middle
  for (const Eigen::Vector3d& v : mesh.vertices) {
    const Eigen::Vector3d x = view.cam_from_world * v;
    reach = std::max({reach, std::abs(x.x() / x.z()) * view.focal_px / (0.5 * kPanelWidth),
                      std::abs(x.y() / x.z()) * view.focal_px / (0.5 * kPanelHeight)});
  }
  view.focal_px *= kFilled / reach;
  MeshLook look;
  look.smooth = false;
  std::vector<uint8_t> pixels = RenderMesh(mesh, view, look);
  cv::Mat bgr;
  cv::cvtColor(cv::Mat(kPanelHeight, kPanelWidth, CV_8UC3, pixels.data()), bgr, cv::COLOR_RGB2BGR);
  return bgr;
}

// Bars in the colours of the errors that they count, the scale beneath, and what lies beyond it at either end.
void DrawHistogram(cv::Mat& sheet, const cv::Rect& box, const ErrorHistogram& histogram) {
  const double tallest = std::max(*std::max_element(histogram.shares.begin(), histogram.shares.end()), 1e-9);
  const auto bins = static_cast<int>(histogram.shares.size());
  const int floor = box.y + box.height - 2 * kTitleHeight;
  const auto x_of = [&](int bin) { return box.x + box.width * bin / bins; };
  cv::line(sheet, {box.x + box.width / 2, box.y}, {box.x + box.width / 2, floor}, kFaint);
  for (int b = 0; b < bins; ++b) {
    const double share = histogram.shares[static_cast<size_t>(b)];
    const double error = histogram.largest_rel * (2 * (b + 0.5) / bins - 1);
    const cv::Scalar color = Bgr(SignedErrorColor(error, histogram.largest_rel));
    const int height = static_cast<int>(std::lround((floor - box.y) * share / tallest));
    const cv::Rect bar(x_of(b), floor - height, x_of(b + 1) - x_of(b), height);
    if (height > 0) {
      cv::rectangle(sheet, bar, color, cv::FILLED);
      cv::rectangle(sheet, bar, kInk, 1);
    }
    cv::rectangle(sheet, cv::Rect(x_of(b), floor + 2, x_of(b + 1) - x_of(b), kScaleHeight), color, cv::FILLED);
  }
  const std::string range = fmt::format("{:g} %", 100 * histogram.largest_rel);
  PutText(sheet, box.x, floor + kTitleHeight, "-" + range);
  PutText(sheet, box.x + box.width / 2 - 4, floor + kTitleHeight, "0");
  PutText(sheet, box.x + box.width - 50, floor + kTitleHeight, range);
  PutText(sheet, box.x, box.y + 12, fmt::format("{:.1f} % below", 100 * histogram.below), 0.4);
  PutText(sheet, box.x + box.width - 90, box.y + 12, fmt::format("{:.1f} % above", 100 * histogram.above), 0.4);
}

}  // namespace

cv::Mat ErrorSheet(const std::vector<ErrorRow>& rows) {
  const int row_height = kTitleHeight + 2 * kPanelHeight;
  cv::Mat sheet(static_cast<int>(rows.size()) * row_height, 2 * kPanelWidth + kPlotWidth + 3 * kMargin, CV_8UC3,
                cv::Scalar::all(255));
  for (size_t r = 0; r < rows.size(); ++r) {
    const int top = static_cast<int>(r) * row_height;
    PutText(sheet, kMargin, top + kTitleHeight - 9, rows[r].title, 0.5);
    for (int side = 0; side < 4; ++side) {
      const cv::Rect place(kMargin + side % 2 * kPanelWidth, top + kTitleHeight + side / 2 * kPanelHeight, kPanelWidth,
                           kPanelHeight);
      Panel(rows[r].colored, kDirections[side]).copyTo(sheet(place));
    }
    const int left = 2 * kPanelWidth + 2 * kMargin;
    PutText(sheet, left, top + kTitleHeight - 9, "share of the surface by signed distance, % of the diagonal", 0.4);
    DrawHistogram(sheet, {left, top + kTitleHeight + 8, kPlotWidth, 2 * kPanelHeight - 2 * kTitleHeight},
                  rows[r].histogram);
    PutText(sheet, left, top + row_height - kTitleHeight, rows[r].numbers, 0.4);
  }
  return sheet;
}

}  // namespace glint
