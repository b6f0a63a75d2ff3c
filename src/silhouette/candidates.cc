#include "silhouette/candidates.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "silhouette/edge_search.h"
#include "silhouette/segment.h"

namespace glint::internal {
namespace {

constexpr int kMaxSide = 320;               // px of the raster
constexpr double kMargin = 0.35;            // of the projection's larger side
constexpr double kReachRel = 0.15;          // of the diagonal: how far outside of the rough mesh the object may be
constexpr double kReachFromHullRel = 0.05;  // outside of what other views leave room for
constexpr double kClippedPx = 2;
constexpr double kCoreRel = 0.05;  // and inside of it from where on it is for sure
constexpr double kNearRel = 0.02;  // around its points, where a hole that the rough mesh spans cannot be
constexpr int kFewPoints = 12;     // in a view: tell nothing of where the object is not
constexpr double kHoleRel = 0.04;  // width of the smallest hole: what is smaller is painted
constexpr double kStep = 2;        // px between samples

double Overlap(const cv::Mat& a, const cv::Mat& b, double a_elsewhere) {
  const double both = cv::countNonZero(a & b), any = cv::countNonZero(a | b);
  return both / std::max(1.0, any + a_elsewhere);
}

void Finish(const Work& work, size_t view, const Raster& raster, const cv::Mat& mask, const cv::Mat& holes,
            Candidate& out) {
  const Eigen::Vector3d eye = work.scene.views[view].Center();
  out.mask = {view, raster, SignedDistance(mask), eye, work.RasterFocal(view, raster)};
  if (cv::countNonZero(holes) > 0) out.mask.hole = SignedDistance(holes);
  for (const ContourPoint& p : Contour(out.mask.distance, kStep))
    if (!raster.NearImageBorder(p.at, work.scene.views[view].camera, 3)) out.contour.push_back(p);
}

// Only what hangs together with what is the object for sure.
cv::Mat WithoutIslands(const cv::Mat& mask, const cv::Mat& core) {
  cv::Mat labels, out = mask.clone();
  std::vector<uint8_t> keep(cv::connectedComponents(mask, labels, 4), 0);
  for (int y = 0; y < mask.rows; ++y)
    for (int x = 0; x < mask.cols; ++x)
      if (core.at<uint8_t>(y, x)) keep[labels.at<int>(y, x)] = 1;
  keep[0] = 0;
  for (int y = 0; y < mask.rows; ++y)
    for (int x = 0; x < mask.cols; ++x)
      if (!keep[labels.at<int>(y, x)]) out.at<uint8_t>(y, x) = 0;
  return out;
}

// Where the object's points are near, CV_8U; everywhere, if too few are seen.
cv::Mat NearPoints(const cv::Mat& hints, double radius) {
  cv::Mat away, labels;
  const cv::Mat elsewhere = hints <= 0;
  if (cv::connectedComponents(~elsewhere, labels, 8) <= kFewPoints)
    return cv::Mat(hints.size(), CV_8U, cv::Scalar(255));
  cv::distanceTransform(elsewhere, away, cv::DIST_L2, cv::DIST_MASK_5);
  return away < radius;
}

// Of what is not in the mask, the pieces that lie within the core and are not small.
cv::Mat HolesOf(const cv::Mat& mask, const cv::Mat& core, double least_px) {
  cv::Mat labels, stats, centroids, within, holes(mask.size(), CV_8U, cv::Scalar(0));
  cv::erode(core, within, cv::Mat());
  const int count = cv::connectedComponentsWithStats(~mask, labels, stats, centroids, 4);
  std::vector<uint8_t> is_hole(count, 1);
  is_hole[0] = 0;
  for (int y = 0; y < mask.rows; ++y)
    for (int x = 0; x < mask.cols; ++x)
      if (!within.at<uint8_t>(y, x)) is_hole[labels.at<int>(y, x)] = 0;
  for (int k = 1; k < count; ++k) is_hole[k] &= stats.at<int>(k, cv::CC_STAT_AREA) >= least_px * least_px;
  for (int y = 0; y < mask.rows; ++y)
    for (int x = 0; x < mask.cols; ++x)
      if (is_hole[labels.at<int>(y, x)]) holes.at<uint8_t>(y, x) = 255;
  return holes;
}

// Where the object goes up to where it was looked for, it may go on: places outside whose nearest bit of outline is
// there become NaN.
void ForgetBeyond(const cv::Mat& mask, const cv::Mat& limit, cv::Mat& distance) {
  cv::Mat nearest, labels;
  cv::distanceTransform(~mask, nearest, labels, cv::DIST_L2, cv::DIST_MASK_5, cv::DIST_LABEL_PIXEL);
  std::vector<uint8_t> clipped(mask.total() + 1, 0);
  for (int y = 0; y < mask.rows; ++y)
    for (int x = 0; x < mask.cols; ++x)
      if (mask.at<uint8_t>(y, x) && limit.at<uint8_t>(y, x)) clipped[labels.at<int>(y, x)] = 1;
  for (int y = 0; y < mask.rows; ++y)
    for (int x = 0; x < mask.cols; ++x)
      if (!mask.at<uint8_t>(y, x) && clipped[labels.at<int>(y, x)])
        distance.at<float>(y, x) = std::numeric_limits<float>::quiet_NaN();
}

cv::Mat Hints(const Work& work, size_t view, const Raster& raster) {
  cv::Mat hints(raster.size, CV_8S, cv::Scalar(0));
  for (size_t i = 0; i < work.scene.points.size(); ++i) {
    if (work.rough.point_side[i] == 0) continue;
    for (const Observation& o : work.scene.points[i].observations) {
      if (o.view != view || !work.scene.views[view].Contains(o.px.cast<double>())) continue;
      const Eigen::Vector2d at = raster.FromImage(o.px.cast<double>());
      const int x = static_cast<int>(std::floor(at.x())), y = static_cast<int>(std::floor(at.y()));
      for (const auto& [dx, dy] : {std::pair{0, 0}, {1, 0}, {-1, 0}, {0, 1}, {0, -1}})
        if (x + dx >= 0 && y + dy >= 0 && x + dx < hints.cols && y + dy < hints.rows)
          hints.at<int8_t>(y + dy, x + dx) = work.rough.point_side[i];
    }
  }
  return hints;
}

}  // namespace

std::optional<Candidate> FromMask(const Work& work, size_t view) {
  cv::Mat mask;
  if (!work.images.LoadMask(view, mask)) return std::nullopt;
  const auto raster = RasterAround(work.scene.views[view], work.rough.mesh, kMargin, kMaxSide);
  if (!raster) return std::nullopt;
  cv::Mat small;
  cv::resize(mask(raster->window), small, raster->size, 0, 0, cv::INTER_AREA);
  small = small > 127;
  Candidate out;
  const double elsewhere =
      (cv::countNonZero(mask) - cv::countNonZero(mask(raster->window))) * raster->scale * raster->scale;
  const cv::Mat rough = ProjectedDistance(work.scene.views[view], work.rough.mesh, *raster);
  out.overlap = Overlap(small, rough < 0, elsewhere);
  out.sigma_px = FineEdgeSigma(*raster);
  Finish(work, view, *raster, small, HolesOf(small, rough < 0, kHoleRel * work.DiagonalPx(view, *raster)), out);
  cv::cvtColor(mask, mask, cv::COLOR_GRAY2BGR);
  out.contour = OnFineEdges(mask, *raster, false, out.contour);
  return out;
}

std::optional<Candidate> FromPhotograph(const Work& work, size_t view, const TriangleMesh* hull) {
  const auto found_raster = RasterAround(work.scene.views[view], hull ? *hull : work.rough.mesh, kMargin, kMaxSide);
  cv::Mat image;
  if (!found_raster || !work.images.Load(view, image)) return std::nullopt;
  const Raster& raster = *found_raster;
  if (image.depth() == CV_16U) image.convertTo(image, CV_8U, 1.0 / 257);
  cv::Mat small;
  cv::resize(image(raster.window), small, raster.size, 0, 0, cv::INTER_AREA);
  const double size = work.DiagonalPx(view, raster);
  const double reach = std::max(3.0, (hull ? kReachFromHullRel : kReachRel) * size);
  const double core = std::max(2.0, kCoreRel * size);
  const cv::Mat rough = ProjectedDistance(work.scene.views[view], work.rough.mesh, raster);
  cv::Mat expected = rough;
  if (hull) {
    // The hull says where the object may be, the rough mesh where it is.
    const cv::Mat room = cv::max(ProjectedDistance(work.scene.views[view], *hull, raster), 0.F);
    expected = cv::min(rough, room);
  }
  const cv::Mat hints = Hints(work, view, raster), inside = expected < -core;
  const Segmentation cut = Segment({small, expected, hints, reach, core, NearPoints(hints, kNearRel * size)});
  const cv::Mat holes = HolesOf(~cut.through, inside, kHoleRel * size);
  const cv::Mat mask = WithoutIslands(cut.object & ~holes, inside);
  Candidate out;
  out.overlap = Overlap(mask, rough < 0, 0);
  out.sigma_px = FineEdgeSigma(raster);
  out.found = true;
  Finish(work, view, raster, mask, holes, out);
  // The mask keeps to the raster's edges, inside of the object's: what it leaves room for is then rather too little.
  out.contour = OnFineEdges(image, raster, true, OnEdges(small, out.contour));
  ForgetBeyond(mask, expected > reach - kClippedPx, out.mask.distance);
  return out;
}

}  // namespace glint::internal
