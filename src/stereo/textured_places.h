// Photo-consistency: where the surface is matte and textured, neighbouring views show the same picture on it only
// where it really is.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "colmap/scene.h"
#include "highlights/sight_colors.h"
#include "light/light.h"
#include "photometry/surface_patches.h"

namespace glint {

// World units.
struct TexturedPlace {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  // of the surface that was searched along
  double sigma = 0;                                  // of the position along the normal, from the views' scatter
};

// For each patch that its squarest view shows with texture: seven by seven samples of its tangent plane are moved along
// the normal, up to `reach_world` either way, and correlated (zero mean, normalised, all channels) with each of up to
// six other views on their own. A place is returned where at least three of them peak at the same offset, well above
// the rest. Views in which one of `lights` is mirrored near the patch are left out: a highlight is no texture. Sees
// nothing where the base is of one colour, and where an edge runs along the views' epipolar lines.
std::vector<TexturedPlace> FindTexturedPlaces(const Scene& scene, const SightColors& colors,
                                              const std::vector<SurfacePatch>& patches,
                                              const std::vector<Light>& lights, double reach_world);

}  // namespace glint
