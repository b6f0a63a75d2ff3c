// A synthetic scene on the disk, as a complete COLMAP project with its ground truth.
#pragma once

#include <filesystem>

#include "core/progress.h"
#include "synthetic/synthesize.h"

namespace glint {

// Writes under `dir` (made if missing; files of the same names are replaced):
//   images/view_000.jpg ...            the photographs
//   sparse/0/{cameras,images,points3D}.bin
//   masks/view_000.jpg.png ...         object masks as an input, if the options ask for them
//   truth/mesh.ply                     the surface, with normals
//   truth/lights.json                  the lights file
//   truth/masks/view_000.jpg.png       255 on the object
//   truth/highlights/view_000.jpg.png  255 where the lights' mirror lobes add more than 0.5 of sensor white
//   truth/highlights.json              {"highlights": [{"image", "x", "y" (COLMAP's pixels), "light", "position",
//                                      "normal" (world), "lit", "strength" (1 = sensor white)}]}
//   truth/points.json                  {"virtual": [ids of points on sliding highlights], "object": [...],
//                                      "surroundings": [...]}
// Throws InputError for a file that cannot be written, CancelledError between views.
void WriteSyntheticProject(const SyntheticScene& scene, const std::filesystem::path& dir,
                           Progress& progress = Progress::Silent());

}  // namespace glint
