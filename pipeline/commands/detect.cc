// glint detect: highlight masks as COLMAP names and reads masks.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

#include "colmap/project.h"
#include "colmap/scene.h"
#include "core/error.h"
#include "core/inside.h"
#include "io/project_images.h"
#include "pipeline/commands/command.h"
#include "pipeline/config.h"
#include "pipeline/image_stages.h"
#include "pipeline/terminal.h"

namespace glint {
namespace {

struct Arguments {
  std::string project, out, images, masks, config;
  std::vector<std::string> settings;
  bool overlays = false;
};

void Detect(const Arguments& arguments, Terminal& terminal) {
  const std::filesystem::path overlays = std::filesystem::path(arguments.out) / "overlays";
  if (!LiesInside(overlays, arguments.out))
    throw InputError(overlays.string(), "", "is a link that leads out of the output folder; remove it");
  const Config config = ResolveConfig(arguments.config, arguments.settings);
  const ProjectPaths paths = FindProject(arguments.project, arguments.images, arguments.masks);
  const Model model = ReadModel(paths.model);
  for (const std::string& warning : model.warnings) terminal.Warn(warning);
  const Scene scene = MakeScene(model);
  const ProjectImages images(scene, paths, terminal);
  const std::vector<Highlight> highlights = DetectInAllViews(scene, images, config.detect, terminal);
  WriteHighlightMasks(scene, highlights, arguments.out, terminal);
  if (arguments.overlays)
    WriteOverlays(scene, images, highlights, config.output.overlay_max_side_px, overlays, terminal);
  terminal.Finish();
  size_t accepted = 0;
  for (const Highlight& h : highlights) accepted += h.status == HighlightStatus::kAccepted;
  terminal.Info(
      fmt::format("{} candidate highlights in {} images; masks in {}", accepted, scene.views.size(), arguments.out));
}

}  // namespace

void AddDetectCommand(CLI::App& app, CommandLine& line) {
  CLI::App* command = app.add_subcommand("detect", "Highlight masks for COLMAP: DIR/<image name>.png, 0 on highlights");
  auto arguments = std::make_shared<Arguments>();
  command->add_option("PROJECT", arguments->project, "Folder of a COLMAP project")->required();
  command->add_option("-o,--out", arguments->out, "Folder for the masks")->required();
  command->add_option("--images", arguments->images, "Folder of the images, if not in the project");
  command->add_option("--masks", arguments->masks, "Folder of masks, if not in the project");
  command->add_option("--config", arguments->config, "YAML file with options to change (see glint config)");
  command->add_option("--set", arguments->settings, "Change one option: section.option=value")->allow_extra_args(false);
  command->add_flag("--overlays", arguments->overlays, "Also draw the highlights into the images, in DIR/overlays");
  AddCommonOptions(*command, line);
  command->callback(
      [arguments, &line] { line.action = [arguments](Terminal& terminal) { Detect(*arguments, terminal); }; });
}

}  // namespace glint
