// Another world: turned, moved and scaled.
#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <vector>

#include "colmap/scene.h"
#include "geometry/triangle_mesh.h"
#include "light/light.h"

namespace glint {

// x_in_reference = scale * R * x + t, read from JSON with the keys "scale", "R" (3 rows of 3) and "t".
// Throws InputError naming file and key.
Eigen::Affine3d ReadSimilarity(const std::filesystem::path& path);

// The same things in another world. A camera's own frame grows with the world, so that its pixels stay.
void Transform(const Eigen::Affine3d& similarity, TriangleMesh& mesh);
void Transform(const Eigen::Affine3d& similarity, Scene& scene);
void Transform(const Eigen::Affine3d& similarity, std::vector<Light>& lights);

}  // namespace glint
