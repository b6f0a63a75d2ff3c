// Photographs of one object differ in exposure, gain and white balance; what they have in common tells by how much.
#pragma once

#include <vector>

#include "colmap/scene.h"
#include "highlights/view_brightness.h"

namespace glint {

// By what factor each view is brighter than the median view, from the scene's points: each is seen by several views,
// and paint looks about the same in all of them, so that the median over many points is the exposure. 1 for a view in
// which too few points tell, or in which they tell no difference beyond their uncertainty.
std::vector<double> RelativeExposures(const Scene& scene, const ViewBrightness& brightness);

}  // namespace glint
