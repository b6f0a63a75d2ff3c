// Candidates that move over the surface: no paint.
#pragma once

#include <cstddef>
#include <vector>

#include "colmap/scene.h"
#include "core/progress.h"
#include "highlights/gate.h"
#include "highlights/highlight.h"
#include "highlights/seed_surface.h"
#include "highlights/view_brightness.h"
#include "light/light.h"

namespace glint {

struct Moving {
  size_t candidate;
  double view_cos;  // between the seed's normal and the direction to the camera
  bool may_move;    // no paint either if a light moved with the camera and so shaded paint anew in every view
};

// What goes dark at its place in the other views. `moving_lights`: to try for lights that move with the camera.
// `stay_put`: how many stay bright there; the rest could not be told.
std::vector<Moving> FindMoving(const Scene& scene, const ViewBrightness& brightness, const SeedSurface& surface,
                               const GateOptions& gate, const std::vector<Highlight>& candidates,
                               const std::vector<Light>& moving_lights, size_t& stay_put, Progress& progress);

// The strongest, and none that is much fainter than they; in the order of the candidates.
std::vector<Moving> Strongest(const std::vector<Highlight>& candidates, const ViewBrightness& brightness,
                              std::vector<Moving> moving, double min_relative_strength, int max_candidates);

}  // namespace glint
