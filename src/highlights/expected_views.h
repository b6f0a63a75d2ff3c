// Where a light should be seen.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "colmap/scene.h"
#include "geometry/triangle_mesh.h"
#include "highlights/seed_surface.h"
#include "light/light.h"

namespace glint {

// By view: whether the seed has a place that would mirror the light to the camera and sees both. `normals`: of the
// seed's vertices.
std::vector<char> ViewsThatShouldShow(const Scene& scene, const SeedSurface& surface, const TriangleMesh& seed,
                                      const std::vector<Eigen::Vector3d>& normals, const Light& light,
                                      double max_incidence_deg);

}  // namespace glint
