// A specular highlight in an image.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string_view>
#include <vector>

namespace glint {

// Why a candidate is or is not used.
enum class HighlightStatus {
  kAccepted,
  kWeak,          // too faint against its surroundings
  kTinted,        // colour of paint, not of the light
  kTooLarge,      // a saturated sky or wall, not a highlight
  kAtBorder,      // touches the image border or the mask's
  kOffSurface,    // its ray misses the seed
  kStaysPut,      // bright in other views at the same surface point: paint
  kWrongNormal,   // no light explains it at any surface point near its ray
  kGrazing,       // incidence above the limit
  kInconsistent,  // contradicts the neighbouring contacts in the bundle
  kNotALobe,      // flat or ragged like print, without the fall-off of a highlight
  kTooFewViews,   // no other views could tell it from paint
  kWrongSize,     // smaller than the surface's curvature at its ray would make it
  kRepeated,      // another scale has found the same highlight better
};
inline constexpr int kNumHighlightStatuses = 14;

std::string_view StatusName(HighlightStatus status);    // "accepted", "stays_put", ... for reports
std::string_view StatusReason(HighlightStatus status);  // a plain sentence for people

struct Highlight {
  uint32_t view = 0;              // index into Scene::views
  Eigen::Vector2d px;             // sub-pixel peak, COLMAP's pixel frame
  Eigen::Matrix2d covariance_px;  // of the peak
  Eigen::Matrix2d moments_px;     // second central moments of the blob: its size and orientation
  double area_px = 0;
  double strength = 0;            // peak specular residual, 1 = sensor white
  double saturated_fraction = 0;  // of the blob's pixels
  double flatness = 0;            // of its top (lobe_profile.h), 0: not known
  int light = -1;                 // index of the assigned light, -1: none yet
  HighlightStatus status = HighlightStatus::kAccepted;
};

}  // namespace glint
