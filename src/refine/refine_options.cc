#include "refine/refine.h"

namespace glint {

void RefineOptions::Visit(OptionVisitor& v) {
  v.Field({.name = "voxel_rel",
           .help = "voxel size of the finest level",
           .unit = "fraction of the diagonal",
           .min = 1e-4,
           .max = 0.1},
          voxel_rel);
  v.Field({.name = "levels", .help = "coarse to fine; each doubles the resolution", .min = 1, .max = 8}, levels);
  v.Field({.name = "half_width_voxels", .help = "of the narrow band", .unit = "voxels", .min = 3, .max = 20},
          half_width_voxels);
  v.Field({.name = "max_iterations", .help = "of bundle and level set, a level", .min = 1, .max = 100}, max_iterations);
  v.Field({.name = "min_motion_voxels",
           .help = "a level is done when the contacts move less (median)",
           .unit = "voxels",
           .min = 0,
           .max = 10},
          min_motion_voxels);
  v.Field({.name = "min_point_sigma_rel",
           .help = "least standard deviation of a sparse point across the surface",
           .unit = "fraction of the diagonal",
           .min = 1e-6,
           .max = 0.1},
          min_point_sigma_rel);
  v.Field({.name = "use_highlights", .help = "false: points and smoothness alone, to see what the highlights add"},
          use_highlights);
  v.Field({.name = "use_lobes", .help = "the shapes of the highlights too, not only their peaks"}, use_lobes);
  v.Field({.name = "use_outlines", .help = "the surface touches the rays through the object's outlines, too"},
          use_outlines);
  v.Field({.name = "method",
           .help = "of a step: variational: the least energy at once; flow: the papers' partial differential equation",
           .choices = {"variational", "flow"}},
          method);
  v.Field(
      {.name = "bend",
       .help = "what costs no bending: seed: to bend like the seed; flat: not to bend; auto: what the constraints are "
               "better explained by",
       .choices = {"auto", "seed", "flat"}},
      bend);
  v.Field({.name = "lights",
           .help = "fixed: as given; solve: refined jointly; auto: those with a standard deviation are solved",
           .choices = {"auto", "fixed", "solve"}},
          lights);
  VisitSection(v, "contacts", "highlights as oriented rays", contacts);
  VisitSection(v, "bundle", "the specular bundle", bundle);
  VisitSection(v, "tilts", "normals from shading and from normal maps", tilts);
  VisitSection(v, "photo", "places from texture (photo-consistency)", photo);
  VisitSection(v, "level_set", "the energy of the level set", level_set);
  VisitSection(v, "flow", "the other method", flow);
}

}  // namespace glint
