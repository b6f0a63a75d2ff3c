#include "highlights/highlight.h"

namespace glint {

std::string_view StatusName(HighlightStatus status) {
  switch (status) {
    case HighlightStatus::kAccepted:
      return "accepted";
    case HighlightStatus::kWeak:
      return "weak";
    case HighlightStatus::kTinted:
      return "tinted";
    case HighlightStatus::kTooLarge:
      return "too_large";
    case HighlightStatus::kAtBorder:
      return "at_border";
    case HighlightStatus::kOffSurface:
      return "off_surface";
    case HighlightStatus::kStaysPut:
      return "stays_put";
    case HighlightStatus::kWrongNormal:
      return "wrong_normal";
    case HighlightStatus::kGrazing:
      return "grazing";
    case HighlightStatus::kInconsistent:
      return "inconsistent";
    case HighlightStatus::kNotALobe:
      return "not_a_lobe";
    case HighlightStatus::kTooFewViews:
      return "too_few_views";
    case HighlightStatus::kWrongSize:
      return "wrong_size";
    case HighlightStatus::kRepeated:
      return "repeated";
  }
  return "unknown";
}

std::string_view StatusReason(HighlightStatus status) {
  switch (status) {
    case HighlightStatus::kAccepted:
      return "agrees with the surface, a light and the other views";
    case HighlightStatus::kWeak:
      return "too faint against its surroundings";
    case HighlightStatus::kTinted:
      return "has the colour of paint, not of the light";
    case HighlightStatus::kTooLarge:
      return "too large for a highlight, like a sky or a wall";
    case HighlightStatus::kAtBorder:
      return "cut off by the border of the image or of its mask";
    case HighlightStatus::kOffSurface:
      return "its ray misses the surface";
    case HighlightStatus::kStaysPut:
      return "stays bright at the same surface point in other views: paint";
    case HighlightStatus::kWrongNormal:
      return "no light is mirrored there by any surface near its ray";
    case HighlightStatus::kGrazing:
      return "the light comes in at too grazing an angle";
    case HighlightStatus::kInconsistent:
      return "contradicts the neighbouring highlights";
    case HighlightStatus::kNotALobe:
      return "flat or ragged like print, without the fall-off of a highlight";
    case HighlightStatus::kTooFewViews:
      return "seen in too few other views to tell it from paint";
    case HighlightStatus::kWrongSize:
      return "too small for the curvature of the surface that its ray meets: it lies elsewhere";
    case HighlightStatus::kRepeated:
      return "the same highlight, found better at another scale";
  }
  return "unknown";
}

}  // namespace glint
