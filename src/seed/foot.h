// Where the object stands.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "colmap/scene.h"
#include "geometry/triangle_mesh.h"
#include "seed/object_choice.h"

namespace glint {

// A scalar of the seed's vertices: 1 where it stands on the ground, else 0; only where there is one.
inline constexpr const char* kFootScalar = "foot";

// Adds it: what is near the plane and faces it.
void MarkFoot(const GroundPlane& ground, TriangleMesh& seed);

// Points on the ground below the object's lowest points: the outline of its foot, and a grid that covers it (world
// units). Empty without a ground, or where the object shows no foot.
std::vector<Eigen::Vector3d> FootPoints(const Scene& scene, const ObjectChoice& choice);

}  // namespace glint
