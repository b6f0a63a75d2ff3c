#include "highlights/find_lights.h"

namespace glint {

void FindLightsOptions::Visit(OptionVisitor& v) {
  v.Field({.name = "max_lights", .help = "Most lights to look for", .unit = "lights", .min = 1, .max = 20}, max_lights);
  v.Field({.name = "min_support",
           .help = "Fewest highlights that make a light",
           .unit = "highlights",
           .min = 3,
           .max = 1000},
          min_support);
  v.Field({.name = "min_completeness",
           .help = "Least highlights of a light, as a share of the views that should show one",
           .unit = "ratio",
           .min = 0,
           .max = 1},
          min_completeness);
  v.Field(
      {.name = "max_normal_sigma_deg",
       .help = "A light that the seed's normals agree with no better is not used: print agrees with any light a little",
       .unit = "deg",
       .min = 0.1,
       .max = 90},
      max_normal_sigma_deg);
  v.Field({.name = "max_sigma_deg",
           .help = "A light that is less certain is not used",
           .unit = "deg",
           .min = 0.1,
           .max = 90},
          max_sigma_deg);
  v.Field({.name = "kinds", .help = "Kinds of lights to look for", .choices = {"any", "distant", "point"}}, kinds);
  v.Field({.name = "max_candidates",
           .help = "Only so many of the strongest candidates vote",
           .unit = "highlights",
           .min = 10,
           .max = 100000},
          max_candidates);
}

}  // namespace glint
