#include "silhouette/edge_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "silhouette/lab.h"

namespace glint::internal {
namespace {

constexpr double kReach = 2.5;      // px to either side
constexpr double kStep = 0.5;       // px
constexpr double kMinContrast = 2;  // Lab units a px: hardly visible
constexpr int kCount = 2 * static_cast<int>(kReach / kStep) + 1;

Eigen::Vector3d ColorAt(const cv::Mat& lab, const Eigen::Vector2d& at) {
  const double x = std::clamp(at.x() - 0.5, 0.0, lab.cols - 1.001), y = std::clamp(at.y() - 0.5, 0.0, lab.rows - 1.001);
  const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
  const auto u = static_cast<float>(x - x0), v = static_cast<float>(y - y0);
  const cv::Vec3f c = (1 - v) * ((1 - u) * lab.at<cv::Vec3f>(y0, x0) + u * lab.at<cv::Vec3f>(y0, x0 + 1)) +
                      v * ((1 - u) * lab.at<cv::Vec3f>(y0 + 1, x0) + u * lab.at<cv::Vec3f>(y0 + 1, x0 + 1));
  return {c[0], c[1], c[2]};
}

}  // namespace

std::vector<ContourPoint> OnEdges(const cv::Mat& image, const std::vector<ContourPoint>& contour) {
  cv::Mat lab = ToLab(image);
  cv::GaussianBlur(lab, lab, cv::Size(), 0.7);
  std::vector<ContourPoint> out;
  if (lab.cols < 2 || lab.rows < 2) return out;
  for (const ContourPoint& p : contour) {
    std::array<double, kCount> slope;
    for (int i = 0; i < kCount; ++i) {
      const double t = -kReach + i * kStep;
      slope[i] = (ColorAt(lab, p.at + (t + 0.5) * p.out) - ColorAt(lab, p.at + (t - 0.5) * p.out)).norm();
    }
    const int best = static_cast<int>(std::max_element(slope.begin(), slope.end()) - slope.begin());
    if (slope[best] < kMinContrast) continue;
    double t = -kReach + best * kStep;
    if (best > 0 && best + 1 < kCount) {
      const double bend = slope[best - 1] - 2 * slope[best] + slope[best + 1];
      if (bend < 0) t += kStep * std::clamp(0.5 * (slope[best - 1] - slope[best + 1]) / bend, -0.5, 0.5);
    }
    out.push_back({p.at + t * p.out, p.out});
  }
  return out;
}

}  // namespace glint::internal
