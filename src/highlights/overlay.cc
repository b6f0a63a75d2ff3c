#include "highlights/overlay.h"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <string>

namespace glint {
namespace {

// The ellipse `sigmas` standard deviations (plus a margin) from the blob's peak, OpenCV's pixel frame.
cv::RotatedRect Ellipse(const Highlight& h, double sigmas, double margin_px) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(h.moments_px);
  const Eigen::Vector2d major = axes.eigenvectors().col(1);
  const double a = sigmas * std::sqrt(std::max(axes.eigenvalues()[1], 0.0)) + margin_px;
  const double b = sigmas * std::sqrt(std::max(axes.eigenvalues()[0], 0.0)) + margin_px;
  const cv::Point2f center(static_cast<float>(h.px.x() - 0.5), static_cast<float>(h.px.y() - 0.5));
  const float angle_deg = static_cast<float>(std::atan2(major.y(), major.x()) * 180 / M_PI);
  return {center, {static_cast<float>(2 * a), static_cast<float>(2 * b)}, angle_deg};
}

const char* ReasonLetters(HighlightStatus status) {
  switch (status) {
    case HighlightStatus::kAccepted:
      return "";
    case HighlightStatus::kWeak:
      return "w";
    case HighlightStatus::kTinted:
      return "t";
    case HighlightStatus::kTooLarge:
      return "L";
    case HighlightStatus::kAtBorder:
      return "b";
    case HighlightStatus::kOffSurface:
      return "o";
    case HighlightStatus::kStaysPut:
      return "P";
    case HighlightStatus::kWrongNormal:
      return "n";
    case HighlightStatus::kGrazing:
      return "g";
    case HighlightStatus::kInconsistent:
      return "i";
    case HighlightStatus::kNotALobe:
      return "f";
    case HighlightStatus::kTooFewViews:
      return "v";
    case HighlightStatus::kWrongSize:
      return "s";
    case HighlightStatus::kRepeated:
      return "r";
  }
  return "?";
}

}  // namespace

cv::Mat DrawHighlights(const cv::Mat& image_bgr, const std::vector<Highlight>& highlights) {
  cv::Mat canvas;
  image_bgr.convertTo(canvas, CV_8U, image_bgr.depth() == CV_16U ? 1.0 / 257 : 1.0);
  if (canvas.channels() == 1) cv::cvtColor(canvas, canvas, cv::COLOR_GRAY2BGR);
  const int line = std::max(1, static_cast<int>(std::lround(std::hypot(canvas.cols, canvas.rows) / 1500)));
  for (const bool accepted : {false, true})
    for (const Highlight& h : highlights) {
      if ((h.status == HighlightStatus::kAccepted) != accepted) continue;
      const cv::Scalar color = !accepted      ? cv::Scalar(40, 40, 255)
                               : h.light >= 0 ? cv::Scalar(60, 255, 60)
                                              : cv::Scalar(60, 200, 255);
      const cv::RotatedRect ellipse = Ellipse(h, 2, 3 * line);
      cv::ellipse(canvas, ellipse, color, line, cv::LINE_AA);
      const std::string label = accepted && h.light >= 0 ? std::to_string(h.light) : ReasonLetters(h.status);
      const cv::Rect box = ellipse.boundingRect();
      cv::putText(canvas, label, {box.x + box.width, box.y + box.height / 2}, cv::FONT_HERSHEY_SIMPLEX, 0.35 * line,
                  color, line, cv::LINE_AA);
      if (accepted) cv::drawMarker(canvas, ellipse.center, color, cv::MARKER_CROSS, 5 * line, line);
    }
  return canvas;
}

cv::Mat HighlightMask(int width, int height, const std::vector<Highlight>& highlights, double margin_px) {
  cv::Mat mask(height, width, CV_8UC1, cv::Scalar(255));
  for (const Highlight& h : highlights) {
    const bool specular = h.status == HighlightStatus::kAccepted || h.status == HighlightStatus::kGrazing ||
                          h.status == HighlightStatus::kInconsistent;
    if (specular) cv::ellipse(mask, Ellipse(h, 2, margin_px), cv::Scalar(0), cv::FILLED);
  }
  return mask;
}

}  // namespace glint
