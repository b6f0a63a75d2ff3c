#include "silhouette/view_mask.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace glint::internal {
namespace {

constexpr int kShift = 6;        // fractional bits of fillConvexPoly
constexpr double kSmooth = 1.2;  // px, of the distances before the outline is taken
constexpr double kBorder = 2;    // px from the raster's border that the outline keeps

// Projected vertices in image px; ones that the camera cannot see are far away.
std::vector<std::optional<Eigen::Vector2d>> Projected(const View& view, const TriangleMesh& mesh) {
  std::vector<std::optional<Eigen::Vector2d>> at;
  at.reserve(mesh.vertices.size());
  for (const Eigen::Vector3d& x : mesh.vertices) at.push_back(view.Project(x));
  return at;
}

float Bilinear(const cv::Mat& image, const Eigen::Vector2d& at) {
  const double x = std::clamp(at.x() - 0.5, 0.0, image.cols - 1.0), y = std::clamp(at.y() - 0.5, 0.0, image.rows - 1.0);
  const int x0 = std::min(static_cast<int>(x), std::max(0, image.cols - 2));
  const int y0 = std::min(static_cast<int>(y), std::max(0, image.rows - 2));
  const int x1 = std::min(x0 + 1, image.cols - 1), y1 = std::min(y0 + 1, image.rows - 1);
  const double u = x - x0, v = y - y0;
  return static_cast<float>((1 - v) * ((1 - u) * image.at<float>(y0, x0) + u * image.at<float>(y0, x1)) +
                            v * ((1 - u) * image.at<float>(y1, x0) + u * image.at<float>(y1, x1)));
}

// A distance in px; outside of the raster it grows with the way from it.
double AtOrBeyond(const cv::Mat& distance, const Eigen::Vector2d& at) {
  const Eigen::Vector2d inside =
      at.cwiseMax(Eigen::Vector2d::Constant(0.5)).cwiseMin(Eigen::Vector2d(distance.cols - 0.5, distance.rows - 0.5));
  return Bilinear(distance, inside) + (at - inside).norm();
}

Eigen::Vector2d Gradient(const cv::Mat& image, const Eigen::Vector2d& at) {
  const Eigen::Vector2d dx(1, 0), dy(0, 1);
  return {(Bilinear(image, at + dx) - Bilinear(image, at - dx)) / 2,
          (Bilinear(image, at + dy) - Bilinear(image, at - dy)) / 2};
}

}  // namespace

bool Raster::NearImageBorder(const Eigen::Vector2d& at, const Camera& camera, double margin) const {
  const Eigen::Vector2d px = ToImage(at);
  const double m = margin / scale;
  return px.x() < m || px.y() < m || px.x() > static_cast<double>(camera.width) - m ||
         px.y() > static_cast<double>(camera.height) - m;
}

cv::Mat SignedDistance(const cv::Mat& mask) {
  const cv::Mat inside = mask > 0;
  const int count = cv::countNonZero(inside);
  if (count == 0) return cv::Mat(mask.size(), CV_32F, cv::Scalar(kFar));
  if (count == static_cast<int>(mask.total())) return cv::Mat(mask.size(), CV_32F, cv::Scalar(-kFar));
  cv::Mat in, out;
  cv::distanceTransform(inside, in, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  cv::distanceTransform(~inside, out, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  // Half a pixel lies between a pixel's centre and the border.
  cv::Mat distance = out - in;
  for (int i = 0; i < static_cast<int>(distance.total()); ++i) {
    float& d = distance.at<float>(i / distance.cols, i % distance.cols);
    d += d > 0 ? -0.5f : 0.5f;
  }
  return distance;
}

std::optional<Raster> RasterAround(const View& view, const TriangleMesh& mesh, double margin, int max_side) {
  const int width = static_cast<int>(view.camera.width), height = static_cast<int>(view.camera.height);
  Eigen::AlignedBox2d box;
  for (const auto& px : Projected(view, mesh))
    if (px) box.extend(px->cwiseMax(Eigen::Vector2d::Zero()).cwiseMin(Eigen::Vector2d(width, height)));
  if (box.isEmpty() || box.sizes().minCoeff() < 4) return std::nullopt;
  const double extra = margin * box.sizes().maxCoeff();
  const cv::Point low(std::max(0, static_cast<int>(box.min().x() - extra)),
                      std::max(0, static_cast<int>(box.min().y() - extra)));
  const cv::Point high(std::min(width, static_cast<int>(box.max().x() + extra) + 1),
                       std::min(height, static_cast<int>(box.max().y() + extra) + 1));
  Raster raster;
  raster.window = cv::Rect(low, high);
  raster.scale = std::min(1.0, static_cast<double>(max_side) / std::max(raster.window.width, raster.window.height));
  raster.size = cv::Size(std::max(1, static_cast<int>(std::lround(raster.window.width * raster.scale))),
                         std::max(1, static_cast<int>(std::lround(raster.window.height * raster.scale))));
  return raster;
}

cv::Mat ProjectedDistance(const View& view, const TriangleMesh& mesh, const Raster& raster) {
  const std::vector<std::optional<Eigen::Vector2d>> at = Projected(view, mesh);
  cv::Mat mask(raster.size, CV_8U, cv::Scalar(0));
  const double far = 16.0 * (raster.size.width + raster.size.height);
  for (const Eigen::Vector3i& f : mesh.faces) {
    std::array<cv::Point, 3> corner;
    bool seen = true;
    for (int k = 0; k < 3 && seen; ++k) {
      seen = at[f[k]].has_value();
      if (!seen) break;
      const Eigen::Vector2d p = raster.FromImage(*at[f[k]]);
      seen = p.cwiseAbs().maxCoeff() < far;
      // OpenCV's centre of the first pixel is (0, 0).
      corner[k] = {static_cast<int>(std::lround((p.x() - 0.5) * (1 << kShift))),
                   static_cast<int>(std::lround((p.y() - 0.5) * (1 << kShift)))};
    }
    if (seen) cv::fillConvexPoly(mask, corner.data(), 3, cv::Scalar(255), cv::LINE_8, kShift);
  }
  return SignedDistance(mask);
}

std::optional<double> ViewMask::DistanceAt(const View& in, const Eigen::Vector2d& px) const {
  if (!in.Contains(px)) return std::nullopt;
  const double there = AtOrBeyond(distance, raster.FromImage(px));
  return std::isnan(there) ? std::nullopt : std::optional(there);
}

double ViewMask::HoleDistanceAt(const Eigen::Vector2d& px) const { return AtOrBeyond(hole, raster.FromImage(px)); }

std::vector<ContourPoint> Contour(const cv::Mat& distance, double step) {
  cv::Mat smooth;
  // Far from the outline the distances of what is all one side would swamp the rest.
  cv::Mat near = cv::min(cv::max(distance, -20.f), 20.f);
  cv::GaussianBlur(near, smooth, cv::Size(), kSmooth);
  std::vector<std::vector<cv::Point>> chains;
  cv::findContours(smooth < 0, chains, cv::RETR_LIST, cv::CHAIN_APPROX_NONE);
  std::vector<ContourPoint> out;
  for (const std::vector<cv::Point>& chain : chains) {
    double along = step;
    for (size_t i = 0; i < chain.size(); ++i) {
      if (i > 0) along += cv::norm(chain[i] - chain[i - 1]);
      if (along < step) continue;
      Eigen::Vector2d at(chain[i].x + 0.5, chain[i].y + 0.5);
      Eigen::Vector2d gradient;
      for (int k = 0; k < 3; ++k) {  // onto the zero level
        gradient = Gradient(smooth, at);
        at -= Bilinear(smooth, at) * gradient / std::max(0.05, gradient.squaredNorm());
      }
      const bool inside =
          at.x() > kBorder && at.y() > kBorder && at.x() < distance.cols - kBorder && at.y() < distance.rows - kBorder;
      if (!inside || gradient.norm() < 0.2 || (at - Eigen::Vector2d(chain[i].x + 0.5, chain[i].y + 0.5)).norm() > 3)
        continue;
      out.push_back({at, gradient.normalized()});
      along = 0;
    }
  }
  return out;
}

}  // namespace glint::internal
