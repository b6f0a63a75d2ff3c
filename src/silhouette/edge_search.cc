#include "silhouette/edge_search.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "silhouette/lab.h"

namespace glint::internal {
namespace {

constexpr double kMinContrast = 2;  // Lab units a px: hardly visible
constexpr double kReach = 2.5;      // px of the raster to either side
constexpr double kFineReach = 1.5;  // the same, about what was found there
// Finer than this the photograph is not looked at: px of the raster. Edges are not sharper, but noise is stronger.
constexpr double kFinest = 0.3;
constexpr double kSigma = 0.5;       // px of what is looked at
constexpr double kLeastSlope = 0.1;  // of 255 a px, of the photograph
constexpr double kRimShare = 0.25;   // of the contrast
constexpr double kRimStep = 0.25;    // units
constexpr double kAroundFrom = 2.5;  // units outside of the steepest place
constexpr int kAroundSteps = 6;      // of half a unit

Eigen::Vector3d ColorAt(const cv::Mat& image, const Eigen::Vector2d& at) {
  const double x = std::clamp(at.x() - 0.5, 0.0, image.cols - 1.001),
               y = std::clamp(at.y() - 0.5, 0.0, image.rows - 1.001);
  const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
  const auto u = static_cast<float>(x - x0), v = static_cast<float>(y - y0);
  const auto at_corner = [&](int dx, int dy) -> cv::Vec3f {
    return image.depth() == CV_8U ? cv::Vec3f(image.at<cv::Vec3b>(y0 + dy, x0 + dx))
                                  : image.at<cv::Vec3f>(y0 + dy, x0 + dx);
  };
  const cv::Vec3f c = (1 - v) * ((1 - u) * at_corner(0, 0) + u * at_corner(1, 0)) +
                      v * ((1 - u) * at_corner(0, 1) + u * at_corner(1, 1));
  return {c[0], c[1], c[2]};
}

struct Edge {
  double offset = 0;  // px
  double slope = 0;   // of the colour, a px
};

// Where a profile of colours, color(offset), is steepest between -reach and reach.
template <class Color>
Edge Steepest(double reach, double unit, const Color& color) {
  const int half = std::max(1, static_cast<int>(std::ceil(reach / (unit / 2))));
  std::vector<Eigen::Vector3d> colors;  // half a unit apart
  for (int i = -half - 1; i <= half + 1; ++i) colors.push_back(color(i * unit / 2));
  std::vector<double> slope;
  for (size_t i = 1; i + 1 < colors.size(); ++i) slope.push_back((colors[i + 1] - colors[i - 1]).norm() / unit);
  const auto best = static_cast<size_t>(std::max_element(slope.begin(), slope.end()) - slope.begin());
  Edge edge{(static_cast<double>(best) - half) * unit / 2, slope[best]};
  if (best > 0 && best + 1 < slope.size()) {
    const double bend = slope[best - 1] - 2 * slope[best] + slope[best + 1];
    if (bend < 0) edge.offset += unit / 2 * std::clamp(0.5 * (slope[best - 1] - slope[best + 1]) / bend, -0.5, 0.5);
  }
  return edge;
}

// A glossy rim mirrors what is behind it more and more: it ends outside of where it looks most different. Outwards from
// there, where the colours are those of the surroundings but for a share.
template <class Color>
double RimOffset(double steepest, double unit, const Color& color) {
  Eigen::Vector3d around = Eigen::Vector3d::Zero();
  for (int k = 0; k < kAroundSteps; ++k) around += color(steepest + (kAroundFrom + 0.5 * k) * unit) / kAroundSteps;
  const Eigen::Vector3d contrast = color(steepest - unit) - around;
  const double squared = contrast.squaredNorm();
  if (!(squared > 0)) return steepest;
  double before = 1;
  for (int k = 0; k * kRimStep < kAroundFrom; ++k) {
    const double t = steepest + k * kRimStep * unit;
    const double left = (color(t) - around).dot(contrast) / squared;
    if (!(left > kRimShare)) return t - (k > 0 ? kRimStep * unit * (kRimShare - left) / (before - left) : 0);
    before = left;
  }
  return steepest;
}

}  // namespace

std::vector<ContourPoint> OnEdges(const cv::Mat& image, const std::vector<ContourPoint>& contour) {
  cv::Mat lab = ToLab(image);
  cv::GaussianBlur(lab, lab, cv::Size(), 0.7);
  std::vector<ContourPoint> out;
  if (lab.cols < 2 || lab.rows < 2) return out;
  for (const ContourPoint& p : contour) {
    const Edge edge = Steepest(kReach, 1, [&](double t) { return ColorAt(lab, p.at + t * p.out); });
    if (edge.slope >= kMinContrast) out.push_back({p.at + edge.offset * p.out, p.out});
  }
  return out;
}

std::vector<ContourPoint> OnFineEdges(const cv::Mat& image, const Raster& raster, bool photograph,
                                      std::vector<ContourPoint> contour) {
  const double unit = std::max(1.0, kFinest / raster.scale);
  if (unit * raster.scale >= 1 || image.cols < 2 || image.rows < 2) return contour;
  for (ContourPoint& p : contour) {
    const Eigen::Vector2d px = raster.ToImage(p.at), along(-p.out.y(), p.out.x());
    const auto color = [&](double t) -> Eigen::Vector3d {
      const Eigen::Vector2d at = px + t * p.out;
      return (ColorAt(image, at - unit * along) + ColorAt(image, at) + ColorAt(image, at + unit * along)) / 3;
    };
    const Edge edge = Steepest(kFineReach / raster.scale, unit, color);
    if (edge.slope < kLeastSlope) continue;  // all of one colour
    const double offset = photograph ? RimOffset(edge.offset, unit, color) : edge.offset;
    p.at = raster.FromImage(px + offset * p.out);
  }
  return contour;
}

double FineEdgeSigma(const Raster& raster) { return kSigma * std::max(raster.scale, kFinest); }

}  // namespace glint::internal
