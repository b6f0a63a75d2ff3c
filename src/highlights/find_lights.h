// Lights that nobody gave: found from the highlights themselves and the seed's normals.
#pragma once

#include <string>
#include <vector>

#include "colmap/scene.h"
#include "core/options.h"
#include "core/progress.h"
#include "geometry/triangle_mesh.h"
#include "highlights/gate.h"
#include "highlights/highlight.h"
#include "io/image_source.h"
#include "light/light_fit.h"

namespace glint {

struct FindLightsOptions {
  int max_lights = 6;
  int min_support = 5;
  double min_completeness = 0.4;
  double max_normal_sigma_deg = 5;
  double max_sigma_deg = 15;
  std::string kinds = "any";
  int max_candidates = 600;

  void Visit(OptionVisitor& v);
};

struct FindLightsSummary {
  size_t candidates = 0;        // accepted by detection
  size_t not_paint = 0;         // of these, what goes dark in the other views
  double normal_sigma_deg = 0;  // of the seed's normals against the half vectors
  double outlier_share = 0;     // of the candidates, explained by no light
  // Not empty: the bright spots are no highlights of a few lights (a mirror of its surroundings, print, relief), and a
  // sentence that says so. Lights found all the same are not to be trusted.
  std::string mirror_like;

  std::vector<FoundLight> lights;  // as returned
  // Photographs under different lights: the first and last of each run; one entry if the light does not change.
  std::vector<std::string> groups;

  std::string BriefReport() const;
};

// Candidates that survive the paint test (gate.h) vote with the seed's normals: l = 2 (n·v) n − v; see FitLights().
// Lights that are not determined (too few highlights, too uncertain) come last, marked, and say why. An empty result is
// an honest one. Where the light changes between groups of photographs, each light says in which it shines. The lights'
// sigma tells the bundle how far they may still be off.
std::vector<FoundLight> FindLights(const Scene& scene, const ImageSource& images, const TriangleMesh& seed,
                                   const GateOptions& gate, const FindLightsOptions& options,
                                   const std::vector<Highlight>& candidates, FindLightsSummary* summary = nullptr,
                                   Progress& progress = Progress::Silent());

}  // namespace glint
