#include "highlights/detect.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/cancel_scope.h"
#include "core/check.h"
#include "highlights/brightness.h"
#include "highlights/lobe_fit.h"
#include "highlights/lobe_profile.h"
#include "highlights/place_index.h"
#include "highlights/scale_space.h"
#include "highlights/tint.h"

namespace glint {
namespace {

// A pixel of a coarse level counts only if all that went into it does.
std::vector<cv::Mat> MaskPyramid(const cv::Mat& mask, const std::vector<cv::Mat>& pyramid) {
  std::vector<cv::Mat> levels;
  if (mask.empty()) return levels;
  cv::Mat binary;
  cv::threshold(mask, binary, 0, 255, cv::THRESH_BINARY);
  levels.push_back(binary);
  while (levels.size() < pyramid.size()) {
    cv::Mat eroded, half;
    cv::erode(levels.back(), eroded, cv::Mat());
    cv::resize(eroded, half, pyramid[levels.size()].size(), 0, 0, cv::INTER_NEAREST);
    levels.push_back(half);
  }
  return levels;
}

// What is known before the peak is fitted.
HighlightStatus FirstLook(const cv::Mat& image, const Blob& blob, double major_px, double max_size_px,
                          const DetectOptions& options) {
  if (blob.unbounded || major_px > max_size_px) return HighlightStatus::kTooLarge;
  if (blob.touches_border) return HighlightStatus::kAtBorder;
  const auto tint_deg = TintDegrees(image, blob, options.saturation);
  return tint_deg && *tint_deg > options.max_tint_deg ? HighlightStatus::kTinted : HighlightStatus::kAccepted;
}

Highlight Describe(const cv::Mat& image, const Blob& blob, const cv::Mat& map, const cv::Mat& mask, uint32_t view,
                   double max_size_px, const DetectOptions& options) {
  const double scale = std::ldexp(1.0, blob.level);
  Highlight h;
  h.view = view;
  h.moments_px = blob.moments * scale * scale;
  h.area_px = blob.area * scale * scale;
  h.strength = blob.peak_value - blob.body;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(h.moments_px);
  // Half height lies two standard deviations from the centre.
  h.status = FirstLook(image, blob, 2 * std::sqrt(axes.eigenvalues()[1]), max_size_px, options);

  LobeFit fit;
  if (h.status == HighlightStatus::kAccepted)
    fit = FitLobe(map, mask, blob.centroid, blob.moments, blob.body, blob.peak_value, options.saturation,
                  options.max_profile_error);
  const Eigen::Vector2d peak = fit.ok ? fit.peak : blob.centroid;
  const Eigen::Matrix2d covariance = fit.ok ? fit.covariance : Eigen::Matrix2d(blob.moments / 2);
  h.px = scale * peak + Eigen::Vector2d(0.5, 0.5);
  // No lobe follows its model to better than a few hundredths of its size.
  h.covariance_px = covariance * scale * scale + 0.03 * 0.03 * h.moments_px +
                    options.position_floor_px * options.position_floor_px * Eigen::Matrix2d::Identity();
  h.saturated_fraction = fit.saturated_fraction;
  h.flatness = Flatness(map, blob, options.saturation);
  if (fit.ok && fit.profile_error > options.max_profile_error) h.status = HighlightStatus::kNotALobe;
  return h;
}

// A glint is found again at coarser levels as the middle of its own halo: what has its peak inside a smaller and
// stronger highlight is that one. Highlights come from fine to coarse.
void DropHaloes(const cv::Size& size, std::vector<Highlight>& highlights) {
  std::vector<Highlight> kept;
  PlaceIndex places(size.width, size.height);
  for (const Highlight& h : highlights) {
    bool halo = false;
    places.At(h.px, [&](size_t index) {
      const Highlight& k = kept[index];
      if (k.area_px > h.area_px || k.strength < h.strength) return;
      const Eigen::Vector2d d = h.px - k.px;
      const double reach = 4 * k.moments_px.trace();
      halo |= d.squaredNorm() < reach && d.dot(k.moments_px.inverse() * d) < 4;
    });
    if (halo) continue;
    places.Put(kept.size(), h.px, 2 * h.moments_px.diagonal().cwiseSqrt());
    kept.push_back(h);
  }
  highlights = std::move(kept);
}

}  // namespace

void DetectOptions::Visit(OptionVisitor& v) {
  v.Field({.name = "min_strength",
           .help = "Least rise over the surroundings",
           .unit = "fraction of sensor white",
           .min = 0.001,
           .max = 1},
          min_strength);
  v.Field({.name = "min_contrast",
           .help = "Least rise relative to the brightness of the surroundings",
           .unit = "ratio",
           .min = 0,
           .max = 100},
          min_contrast);
  v.Field({.name = "max_size_rel",
           .help = "Largest radius of a highlight",
           .unit = "fraction of the image's diagonal",
           .min = 0.001,
           .max = 1},
          max_size_rel);
  v.Field({.name = "max_tint_deg",
           .help = "Largest angle between the added colour and white or the body's own colour",
           .unit = "deg",
           .min = 0,
           .max = 90},
          max_tint_deg);
  v.Field({.name = "max_profile_error",
           .help = "Largest mean deviation from a lobe's profile",
           .unit = "fraction of the rise",
           .min = 0,
           .max = 1},
          max_profile_error);
  v.Field({.name = "saturation",
           .help = "Linear brightness from which a pixel only says 'at least that bright'",
           .unit = "fraction of sensor white",
           .min = 0.1,
           .max = 1},
          saturation);
  v.Field({.name = "position_floor_px",
           .help = "Standard deviation that no peak falls below",
           .unit = "px",
           .min = 0.001,
           .max = 10},
          position_floor_px);
}

std::vector<Highlight> DetectHighlights(const cv::Mat& image_bgr, const cv::Mat& mask, uint32_t view,
                                        const DetectOptions& options) {
  GLINT_CHECK(mask.empty() || (mask.size() == image_bgr.size() && mask.type() == CV_8UC1));
  const std::vector<cv::Mat> pyramid = BrightnessPyramid(LinearMinChannel(image_bgr));
  const std::vector<cv::Mat> masks = MaskPyramid(mask, pyramid);
  const double max_size_px = options.max_size_rel * std::hypot(image_bgr.cols, image_bgr.rows);
  const std::vector<Blob> blobs = FindBlobs(pyramid, masks, {options.min_strength, options.min_contrast, max_size_px});

  std::vector<Highlight> highlights;
  for (const Blob& blob : blobs) {
    CancelScope::Current().ThrowIfCancelled();
    highlights.push_back(Describe(image_bgr, blob, pyramid[blob.level], masks.empty() ? cv::Mat() : masks[blob.level],
                                  view, max_size_px, options));
  }
  DropHaloes(image_bgr.size(), highlights);
  std::stable_sort(highlights.begin(), highlights.end(), [](const Highlight& a, const Highlight& b) {
    if (a.strength != b.strength) return a.strength > b.strength;
    return a.px.y() != b.px.y() ? a.px.y() < b.px.y() : a.px.x() < b.px.x();
  });
  return highlights;
}

}  // namespace glint
