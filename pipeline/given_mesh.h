// A mesh that the user gives in place of the seed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "colmap/scene.h"
#include "core/options.h"
#include "geometry/triangle_mesh.h"

namespace glint {

struct GivenMeshOptions {
  double point_distance_rel = 0.02;
  double closing_voxel_rel = 0.005;
  void Visit(OptionVisitor& v);
};

struct GivenMesh {
  TriangleMesh mesh;                // closed, oriented outward
  std::vector<uint8_t> point_used;  // of the scene: lies near the mesh
  std::vector<std::string> notes;   // what was mended
};

// Reads a mesh in the model's frame; one that is open, not manifold or inside out is made sound by way of a
// signed distance field (winding number). Throws InputError when the file is no mesh, no view sees it, or it encloses
// nothing.
GivenMesh ReadGivenMesh(const std::filesystem::path& path, const Scene& scene, const GivenMeshOptions& options);

}  // namespace glint
