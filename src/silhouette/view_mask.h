// The object's mask in one view, on a raster around it. Only for .cc files of this module: it brings OpenCV along.
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "colmap/scene.h"
#include "geometry/triangle_mesh.h"

namespace glint::internal {

// A window of the image, in whole pixels, at a scale. Coordinates from the corner, as COLMAP's.
struct Raster {
  cv::Rect window;   // in the image
  double scale = 1;  // raster px per image px
  cv::Size size;

  Eigen::Vector2d FromImage(const Eigen::Vector2d& px) const {
    return {(px.x() - window.x) * size.width / window.width, (px.y() - window.y) * size.height / window.height};
  }
  Eigen::Vector2d ToImage(const Eigen::Vector2d& at) const {
    return {window.x + at.x() * window.width / size.width, window.y + at.y() * window.height / size.height};
  }
  // On the image's border, where nothing is known of what goes on outside.
  bool NearImageBorder(const Eigen::Vector2d& at, const Camera& camera, double margin) const;
};

// CV_32F: distance from the border of a mask (CV_8U, non-zero inside) in its px, negative inside. A mask that is all
// one side: +-kFar.
inline constexpr float kFar = 1e6f;
cv::Mat SignedDistance(const cv::Mat& mask);

// Around the mesh's projection with `margin` of its larger side, at most `max_side` px. Nothing if it is not in the
// image.
std::optional<Raster> RasterAround(const View& view, const TriangleMesh& mesh, double margin, int max_side);

// SignedDistance() of the mesh's projection.
cv::Mat ProjectedDistance(const View& view, const TriangleMesh& mesh, const Raster& raster);

// A mask that is used: signed distance from its outline in raster px.
struct ViewMask {
  size_t view = 0;
  Raster raster;
  cv::Mat distance;  // NaN: not known
  Eigen::Vector3d eye;
  double focal_px = 0;  // in the raster's px
  cv::Mat hole = {};    // as `distance`, from the border of holes in the outline, negative in them; empty: none

  // Distance in raster px at image px; outside of the raster grows with the way from it. Nothing outside of the image
  // and where it is not known.
  std::optional<double> DistanceAt(const View& in, const Eigen::Vector2d& px) const;
  // From the border of the holes, of which there are some; negative in them.
  double HoleDistanceAt(const Eigen::Vector2d& px) const;
};

// A place on the outline with its direction out of the object, raster px.
struct ContourPoint {
  Eigen::Vector2d at, out;
};
// About every `step` px along the zero level of the distances, smoothed over a pixel; not along the raster's border.
std::vector<ContourPoint> Contour(const cv::Mat& distance, double step);

}  // namespace glint::internal
