// Where the highlights really are.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "synthetic/stage.h"

namespace glint {

// A point of the object, visible in the view, whose normal is the half vector of view and light: there the mirror lobe
// peaks (up to the slow change of Fresnel's term and masking across it).
struct TrueHighlight {
  Eigen::Vector2d px;        // COLMAP's pixel frame
  Eigen::Vector3d position;  // the contact, on the surface
  Eigen::Vector3d normal;    // unit, outward
  int light = 0;
  bool lit = true;      // false where the light's centre is hidden there
  double strength = 0;  // of the lobe's peak, were it lit; 1 is sensor white
};

// Samples of one view at pixels stride · (i + ½): cosine between the normal and the half vector, -1 off the object.
struct LobeMap {
  int width = 0, height = 0;
  double stride = 1;
  std::vector<float> cosine;
};

LobeMap MakeLobeMap(const Stage& stage, const StageView& view, size_t light, double stride);

// Local maxima of the map, refined to about 1e-9 in the angle between normal and half vector. In the stage's frame.
// Peaks that the map's stride steps over (on sharply curved edges) are missed.
std::vector<TrueHighlight> FindTrueHighlights(const Stage& stage, const StageView& view, size_t light,
                                              const LobeMap& map);

}  // namespace glint
