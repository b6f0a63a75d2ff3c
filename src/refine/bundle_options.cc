#include "refine/bundle.h"

namespace glint {

void BundleOptions::Visit(OptionVisitor& v) {
  v.Field({.name = "neighbors", .help = "chords of a contact to its neighbours", .min = 2, .max = 100}, neighbors);
  v.Field({.name = "max_normal_angle_deg",
           .help = "no chord between contacts whose normals differ by more",
           .unit = "deg",
           .min = 1,
           .max = 90},
          max_normal_angle_deg);
  v.Field({.name = "prior_sigma_rel",
           .help = "how far the seed may be from the surface; a weak pull that decides only where nothing else does",
           .unit = "fraction of the diagonal",
           .min = 1e-4,
           .max = 1},
          prior_sigma_rel);
  v.Field({.name = "point_normal_sigma_deg",
           .help = "standard deviation of the current surface's normal at a sparse point",
           .unit = "deg",
           .min = 0.1,
           .max = 60},
          point_normal_sigma_deg);
  v.Field(
      {.name = "reject_sigmas",
       .help = "a contact whose chords contradict its neighbours by more (median, in standard deviations) is left out",
       .min = 1,
       .max = 100},
      reject_sigmas);
  v.Field({.name = "rounds", .help = "solves with neighbours chosen anew in between", .min = 1, .max = 50}, rounds);
}

}  // namespace glint
