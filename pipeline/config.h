// The whole configuration of a run: every stage's options as a section.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/options.h"
#include "highlights/detect.h"
#include "highlights/find_lights.h"
#include "highlights/gate.h"
#include "io/normal_map_files.h"
#include "pipeline/given_mesh.h"
#include "pipeline/photo_stage.h"
#include "refine/refine.h"
#include "seed/build_seed.h"

namespace glint {

// What is not a stage's own.
struct OutputOptions {
  bool overlays = true;
  int overlay_max_side_px = 1600;
  bool highlight_masks = true;
  bool obj = false;
  bool glb = false;
  double memory_fraction = 0.8;
  void Visit(OptionVisitor& v);
};

struct Config {
  PhotoOptions photos;
  SeedOptions seed;
  GivenMeshOptions given_mesh;
  DetectOptions detect;
  FindLightsOptions lights;
  GateOptions gate;
  NormalMapOptions normals;
  RefineOptions refine;
  OutputOptions output;
  void Visit(OptionVisitor& v);
};

// Defaults, then the file (if not empty), then each "path=value" of --set, then validation. Throws InputError that
// lists every problem, one a line, with file and line, path, value and what was expected.
Config ResolveConfig(const std::filesystem::path& file, const std::vector<std::string>& settings);

// As commented YAML that ResolveConfig reads back to the same values.
std::string ConfigYaml(Config config, const std::string& title);

// What `glint config` prints and configs/default.yaml holds.
std::string DefaultConfigYaml();

}  // namespace glint
