// Where viewing rays touch the object: its outline in the photographs.
#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace glint {

// The surface meets the ray somewhere in [near, far] and nowhere passes through it there: `normal` is the surface's own
// normal at that place. Across the ray the place is known to `sigma`; along it only as well as other views tell.
struct OutlineSample {
  uint32_t view = 0;       // index into Scene::views
  Eigen::Vector2d px;      // COLMAP's frame
  Eigen::Vector3d ray;     // unit, world, from the view's centre through px
  Eigen::Vector3d normal;  // unit, world, out of the object, at right angles to the ray
  double depth = 0;        // along the ray, world units: where the outlines of all views together come nearest to it
  double near = 0;         // the other views' outlines leave room for the surface from here
  double far = 0;          // to here
  double sigma = 0;        // world units at `depth`: standard deviation across the outline
};

}  // namespace glint
