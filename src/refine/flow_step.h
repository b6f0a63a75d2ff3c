// The level set moved by the papers' partial differential equation [SAH03, Solem and Overgaard 2005; DESIGN 3.4,
// "flow"]: the other way, beside level_set_step.h, to bring the surface to fixed contacts.
#pragma once

#include "core/options.h"
#include "refine/level_set_step.h"
#include "sdf/level_set.h"

namespace glint {

struct FlowOptions {
  double alignment = 0.3;
  double points = 0.1;
  double curvature = 0.002;
  double force = 300;
  double kernel_share = 0.5;
  double point_reach_rel = 0.03;
  int max_steps = 120;
  void Visit(OptionVisitor& v);
};

// Explicit steps of
//   φ_t = |∇φ| [ α (h κ + ∇h·n − ∇·(h w)) + β (∇d·n + d κ) + γ κ + F ]
// with w the contacts' normals and h their weights, Gaussian about each contact (a share of its reach), d the distance
// to the next sparse point (at most point_reach_rel), κ the mean curvature (sum of the principal ones) and F the
// distance to where the bundle has the contacts, carried by the same Gaussians. Upwind for what advects and for the
// speed along the normal, central for curvature, time steps at 0.45 of the CFL limit, true distances again whenever the
// surface may have moved by half a voxel. Stops when the surface has come to rest, or after max_steps. The summary's
// energies are those of the alignment, ∫ h (1 − n·w). All in units of the object's diagonal; needs nothing of `input`
// but surface, contacts and points. About 90 ns a voxel and step on one core.
LevelSet FlowStep(const StepInput& input, const FlowOptions& options, StepSummary* summary);

}  // namespace glint
