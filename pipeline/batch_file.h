// The list of projects for `glint run --batch`:
//   out: results                 # each project's results go into results/NAME
//   config: common.yaml          # for all; also lights, mesh, images, masks, normals and set may stand here
//   projects:
//     - project: scans/hood      # a folder; NAME is its name unless `name` or `out` says otherwise
//       set: {refine.voxel_rel: 0.005}
//     - {project: scans/vase, name: vase-flash, config: flash.yaml}
// Paths are relative to the file's folder.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace glint {

struct BatchProject {
  std::string name;
  std::filesystem::path project, out, config, lights, mesh, images, masks, normals;  // empty: not given
  std::vector<std::string> settings;                                                 // "path=value"
};

// Throws InputError that lists every problem with file and line: unknown keys, a missing project, two projects that
// would write into the same folder, ...
std::vector<BatchProject> ReadBatchFile(const std::filesystem::path& file);

}  // namespace glint
