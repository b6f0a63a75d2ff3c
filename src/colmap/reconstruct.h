// Photographs to a COLMAP model, by the installed program `colmap`.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "colmap/photographs.h"
#include "core/options.h"
#include "core/progress.h"

namespace glint {

struct ReconstructOptions {
  std::string program = "colmap";
  std::string matcher = "auto";
  std::string vocabulary_tree;
  int max_pairs = 3000;
  std::string cameras = "auto";
  std::string camera_model = "SIMPLE_RADIAL";
  int max_side_px = 3200;
  bool use_gpu = true;
  double stall_limit_min = 30;
  double time_limit_min = 0;

  void Visit(OptionVisitor& v);
};

struct ReconstructStep {
  std::string name;  // "features", "matches", "mapper"
  double seconds = 0;
  bool reused = false;  // an earlier run had finished it
};

struct ReconstructSummary {
  std::string version;  // of COLMAP
  bool gpu = false;
  std::string matcher;  // "exhaustive", "sequence", "vocabulary"
  size_t num_images = 0;
  size_t median_features = 0;       // of an image; 0: not known
  std::vector<size_t> model_sizes;  // registered images, the largest first
  std::vector<ReconstructStep> steps;

  size_t num_registered() const { return model_sizes.empty() ? 0 : model_sizes.front(); }
  std::string BriefReport() const;
  // What a person can do for more images to register, the likeliest first.
  std::vector<std::string> Advice() const;
};

// Leaves a COLMAP project in `folder`: database.db, sparse/0 ..., and log.txt with all that COLMAP said. What an
// earlier call with the same photographs and options has finished there is not done again; one that was stopped goes
// on, features and matches where it was. That no image registers is a value in the summary. Throws InputError: no
// colmap, one that fails, hangs or takes too long (with what it said last), an option that it does not know.
ReconstructSummary Reconstruct(const Photographs& photographs, const std::filesystem::path& folder,
                               const ReconstructOptions& options, Progress& progress);

}  // namespace glint
