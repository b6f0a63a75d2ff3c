#include "highlights/gate.h"

namespace glint {

void GateOptions::Visit(OptionVisitor& v) {
  v.Field({.name = "seed_error_rel",
           .help = "How far the seed may lie off the surface",
           .unit = "fraction of the diagonal",
           .min = 0.0001,
           .max = 0.5},
          seed_error_rel);
  v.Field({.name = "max_normal_error_deg",
           .help = "Largest angle between half vector and the seed's normals nearby",
           .unit = "deg",
           .min = 0,
           .max = 180},
          max_normal_error_deg);
  v.Field(
      {.name = "max_incidence_deg", .help = "Largest incidence angle of the light", .unit = "deg", .min = 0, .max = 89},
      max_incidence_deg);
  v.Field({.name = "min_half_change_deg",
           .help = "Views whose half vector differs by less are not compared with to tell paint",
           .unit = "deg",
           .min = 0,
           .max = 90},
          min_half_change_deg);
  v.Field({.name = "paint_ratio",
           .help = "Paint keeps at least this fraction of its brightness over the body in the other views",
           .unit = "ratio",
           .min = 0,
           .max = 2},
          paint_ratio);
  v.Field({.name = "min_other_views",
           .help = "Fewest other views that can tell paint",
           .unit = "views",
           .min = 1,
           .max = 1000},
          min_other_views);
  v.Field({.name = "min_relative_strength",
           .help = "Least strength, relative to the strong highlights of its light",
           .unit = "ratio",
           .min = 0,
           .max = 1},
          min_relative_strength);
  v.Field({.name = "image_memory_mb",
           .help = "Memory for small copies of all views",
           .unit = "MB",
           .min = 16,
           .max = 65536},
          image_memory_mb);
}

}  // namespace glint
