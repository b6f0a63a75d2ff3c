// Where a mesh that is compared lies in the reference's frame.
#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <string>

#include "core/progress.h"
#include "geometry/triangle_mesh.h"

namespace glint {

struct Placement {
  Eigen::Affine3d reference_from_mesh = Eigen::Affine3d::Identity();
  std::string aligned;  // what was done to lay it there, as a sentence; else empty
  std::string doubt;    // why the frames may not be the same, as a sentence; else empty
};

// From a file as ReadSimilarity() reads it (empty: none), and then, if `align` is "rigid" or "similarity" and not
// empty, by AlignMeshes().
Placement PlaceOnReference(const TriangleMesh& mesh, const TriangleMesh& reference,
                           const std::filesystem::path& transform, const std::string& align, Progress& progress);

}  // namespace glint
