// The seed of a run: made from the sparse points, or from a mesh that the user gives.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "colmap/scene.h"
#include "core/progress.h"
#include "geometry/triangle_mesh.h"
#include "io/image_source.h"
#include "pipeline/config.h"
#include "silhouette/outline.h"

namespace glint {

struct SeedStageResult {
  TriangleMesh mesh;                // closed, oriented outward, in the model's frame; empty: `warnings` say why
  TriangleMesh start;               // what refinement starts on: `mesh` faired through the points, or as it was given
  std::vector<uint8_t> point_used;  // a scene point: lies on the object
  std::vector<OutlineSample> outline;  // of the object, as far as the views agree on it
  TriangleMesh points;                 // the scene's, coloured by what became of them; empty for a given mesh
  std::string report;                  // one line for people
  std::vector<std::string> notes;
  std::vector<std::string> warnings;
};

// `given_mesh`: empty to make the seed from the points. Throws InputError.
SeedStageResult RunSeedStage(const Scene& scene, const ImageSource& images, const std::filesystem::path& given_mesh,
                             const Config& config, Progress& progress);

}  // namespace glint
