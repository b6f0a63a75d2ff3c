// The gate that counts: which candidates agree with the surface, a light and the other views.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "colmap/scene.h"
#include "core/options.h"
#include "core/progress.h"
#include "geometry/triangle_mesh.h"
#include "highlights/highlight.h"
#include "io/image_source.h"
#include "light/light.h"

namespace glint {

struct GateOptions {
  double seed_error_rel = 0.03;      // fraction of the seed's diagonal
  double max_normal_error_deg = 25;  // half vector against the seed's normals nearby
  double max_incidence_deg = 60;
  double min_half_change_deg = 8;  // views whose half vector differs by less say nothing on paint
  double paint_ratio = 0.55;       // of the candidate's brightness over its body, in the median of the other views
  int min_other_views = 3;
  double min_relative_strength = 0.3;  // of the strong ones of the same light
  int image_memory_mb = 512;

  void Visit(OptionVisitor& v);
};

struct GateSummary {
  size_t candidates = 0;
  size_t accepted = 0;
  std::array<size_t, kNumHighlightStatuses> by_status{};
  std::vector<size_t> accepted_by_light;        // one entry a light
  std::vector<double> median_normal_error_deg;  // of the accepted ones of each light, against the seed
  double ambiguous_fraction = 0;                // of the accepted: two lights explain it about as well

  std::string BriefReport() const;
};

// Decides `status` and `light` of every candidate that detection has accepted; the others are left alone.
// A candidate is back-projected through the seed, with neighbours within seed_error_rel of its hit, for the seed is
// only about right in place and normal. The light whose half vector disagrees least with a normal there is assigned.
// Paint: for every depth along the ray within the seed's error, the brightness of the surface point in the other
// unoccluded views in which that light would be mirrored elsewhere; if at any depth the median stays bright, it is
// paint. What is much fainter than the strong highlights of the same light is texture that slipped through: one lamp
// on one object varies by Fresnel's factor, not by orders of magnitude. Of a lobe that was found at several scales the
// find that is known best stays. Accepted peaks are moved to the point that mirrors the light, beside which broad lobes
// peak on a surface that is seen aslant. `images` is streamed once into small grey copies (image_memory_mb in all).
void GateHighlights(const Scene& scene, const ImageSource& images, const TriangleMesh& seed,
                    const std::vector<Light>& lights, const GateOptions& options, std::vector<Highlight>& highlights,
                    GateSummary* summary = nullptr, Progress& progress = Progress::Silent());

}  // namespace glint
