// A run that begins with photographs or a film: COLMAP makes the project.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "colmap/reconstruct.h"
#include "core/options.h"
#include "core/progress.h"
#include "io/video.h"

namespace glint {

struct PhotoOptions {
  ReconstructOptions colmap;
  VideoOptions video;
  std::string feature_masks;
  double min_registered = 0.2;

  void Visit(OptionVisitor& v);
};

struct PhotoStageResult {
  std::filesystem::path project;       // where FindProject() is to look
  std::filesystem::path images;        // empty: in the project
  std::filesystem::path masks;         // of the object, beside the photographs; empty: none
  std::vector<ReconstructStep> steps;  // of COLMAP; empty: `given` was a project
  std::string colmap_version;          // empty: COLMAP was not needed
  std::string report;                  // one line for people, if COLMAP was needed
  std::string why_not;                 // too few images register, and what to do; empty: they do
};

// `given`: a COLMAP project, which is handed on as it is; or a folder of photographs or a film, of which `folder`
// becomes a COLMAP project. `out`: where the run writes; photographs in it are not meant. Damaged photographs are left
// out with a warning. Throws InputError.
PhotoStageResult RunPhotoStage(const std::filesystem::path& given, const std::filesystem::path& folder,
                               const std::filesystem::path& out, const PhotoOptions& options, Progress& progress);

}  // namespace glint
