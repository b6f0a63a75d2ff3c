#include "pipeline/config.h"

#include <fmt/format.h>

#include "pipeline/config_file.h"
#include "pipeline/option_table.h"

namespace glint {

void OutputOptions::Visit(OptionVisitor& v) {
  v.Field({.name = "overlays", .help = "Write each image with its highlights drawn into highlights/."}, overlays);
  v.Field({.name = "overlay_max_side_px",
           .help = "Larger images are scaled down to this for their overlay.",
           .unit = "px",
           .min = 64,
           .max = 65535},
          overlay_max_side_px);
  v.Field(
      {.name = "highlight_masks", .help = "Write highlight_masks/: masks as COLMAP reads them, 0 on the highlights."},
      highlight_masks);
  v.Field({.name = "obj", .help = "Write mesh.obj too."}, obj);
  v.Field({.name = "glb", .help = "Write mesh.glb (glTF) too."}, glb);
  v.Field({.name = "memory_fraction",
           .help = "Refuse to start when the level set would need more than this part of the memory that is free.",
           .min = 0.01,
           .max = 1},
          memory_fraction);
}

void Config::Visit(OptionVisitor& v) {
  VisitSection(v, "photos", "From photographs or a film to a COLMAP project.", photos);
  VisitSection(v, "seed", "The mesh to start on, from the sparse points.", seed);
  VisitSection(v, "given_mesh", "A mesh given with --mesh in place of the seed.", given_mesh);
  VisitSection(v, "detect", "Highlights in a single image.", detect);
  VisitSection(v, "lights", "Finding lights that are not given.", lights);
  VisitSection(v, "gate", "Which of them agree with the surface, a light and the other views.", gate);
  VisitSection(v, "normals", "Normal maps of the photographs, given with --normals.", normals);
  VisitSection(v, "refine", "Specular bundle and level set in turn, coarse to fine.", refine);
  VisitSection(v, "output", "What is written, and the limits of the machine.", output);
}

Config ResolveConfig(const std::filesystem::path& file, const std::vector<std::string>& settings) {
  Config config;
  const OptionTable table(config);
  ConfigProblems problems;
  if (!file.empty()) ReadYamlFile(file, table, problems);
  for (const std::string& setting : settings) ApplySetting(setting, table, problems);
  for (const std::string& violation : Violations(config)) {
    const auto origin = problems.origin.find(violation.substr(0, violation.find(" = ")));
    problems.messages.push_back(origin == problems.origin.end() ? violation : origin->second + ": " + violation);
  }
  problems.ThrowIfAny();
  return config;
}

std::string ConfigYaml(Config config, const std::string& title) { return WriteYaml(OptionTable(config), title); }

std::string DefaultConfigYaml() {
  return ConfigYaml(
      Config(),
      "Glint's options with their default values: `glint config` prints this file. Give a file with only "
      "the options to change to `glint run --config FILE`, or single ones with `--set section.option=value`.");
}

}  // namespace glint
