// Which of the lights that were found are to be used, and what else their highlights say.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "colmap/scene.h"
#include "highlights/find_lights.h"
#include "highlights/highlight.h"
#include "highlights/seed_surface.h"
#include "light/found_light.h"

namespace glint {

// Of one light, beside what FitLights() says.
struct LightEvidence {
  double spread_world = 0;         // rms distance of its highlights on the surface from their middle
  int expected_views = 0;          // in which the surface has a place that would mirror it
  std::vector<double> widths_deg;  // of its highlights' lobes (mirror_test.h)
  double half_sigma_deg = 0;       // how uncertain it leaves the half vectors at its highlights
  // Of each highlight, by light: the least angle between that light's half vector and the seed's normals about it.
  std::vector<std::vector<double>> off_deg = {};
};

// Sets the evidence's `off_deg`. About a highlight: where rays meet the seed within about as far as the seed may be
// off.
void MeasureOff(const Scene& scene, const SeedSurface& surface, const std::vector<Highlight>& highlights,
                const std::vector<FoundLight>& lights, LightEvidence& evidence);

// Sets `determined` and `why` of every light. One that shows in few of the views that should show it is a chance
// agreement of marks, unless the other lights of the same object show in no more: highlights are missed for reasons
// that all lights share. So is one with highlights no denser than those of a crowd that agrees with no light but
// broadly. `lights`: by falling support.
void JudgeLights(const std::vector<LightEvidence>& evidence, double diagonal, const FindLightsOptions& options,
                 std::vector<FoundLight>& lights);

// No lamp makes highlights that are narrower than the lobe of the gloss, and that is what another lamp, if it is a
// small one, makes: a cluster of smaller ones is paint. How wide a lobe looks depends on what the seed's curvature is
// off at its place, which the gloss' own widths show by their scatter; highlights of a cluster may share a place, and
// so be off together by as much as one of the gloss' is: narrower is what two standard deviations of that do not
// explain.
bool NarrowerThanGloss(const std::vector<double>& gloss_deg, const std::vector<double>& cluster_deg);

// Counts of candidates.
struct BrightSpots {
  size_t views = 0;
  size_t moving = 0;    // go dark at their place in the other views
  size_t stay_put = 0;  // do not
  size_t voting = 0;    // of the moving ones, for lights
};

// What the bright spots are if a few lights do not explain them, as a sentence; else empty.
std::string NotHighlights(const BrightSpots& spots, const std::vector<FoundLight>& lights);

}  // namespace glint
