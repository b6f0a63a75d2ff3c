// glint run: the main job.
#include "pipeline/run.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/commands/command.h"
#include "pipeline/config.h"
#include "pipeline/terminal.h"

namespace glint {
namespace {

struct Arguments {
  RunArguments run;
  std::string from, until;
  bool force = false;
  std::vector<std::string> settings;
};

std::optional<RunStage> StageNamed(const std::string& name) {
  const auto found = std::find(kRunStageNames.begin(), kRunStageNames.end(), name);
  if (found == kRunStageNames.end()) return std::nullopt;
  return static_cast<RunStage>(found - kRunStageNames.begin());
}

void Say(const RunSummary& summary, const std::filesystem::path& out, Terminal& terminal) {
  if (summary.outcome == "nothing to do")
    terminal.Info(
        fmt::format("{}: nothing to do: program, project and options are those that made what is there "
                    "(--force does it anew)",
                    out.string()));
  else if (summary.outcome == "done")
    terminal.Info(fmt::format("{}: mesh.ply ({} faces), sdf.vdb, report.json", out.string(), summary.num_faces));
  else
    terminal.Info(fmt::format("{}: {}; the same command without --until goes on", out.string(), summary.outcome));
}

}  // namespace

void AddRunCommand(CLI::App& app, CommandLine& line) {
  CLI::App* command = app.add_subcommand("run", "The main job: a COLMAP project, photographs or a film in, a mesh out");
  auto arguments = std::make_shared<Arguments>();
  command->add_option("PROJECT", arguments->run.project, "A COLMAP project, a folder of photographs, or a film")
      ->required();
  command->add_option("-o,--out", arguments->run.out, "Folder for the results")->required();
  command->add_option("--config", arguments->run.config, "YAML file with options to change (see glint config)");
  command->add_option("--set", arguments->settings, "Change one option: section.option=value")->allow_extra_args(false);
  command->add_option("--lights", arguments->run.lights, "JSON file with the lights");
  command->add_option("--mesh", arguments->run.mesh,
                      "Start from this mesh, in the project's frame, not from the points");
  command->add_option("--images", arguments->run.images, "Folder of the images, if not in the project");
  command->add_option("--masks", arguments->run.masks,
                      "Folder of masks (IMAGE.png, 0 is ignored), if not in the project");
  command->add_option_function<std::string>(
      "--box", [arguments](const std::string& box) { arguments->settings.push_back("seed.object.box=" + box); },
      "The object is in this box of the project's frame, --box=X,Y,Z,SX,SY,SZ: centre and size");
  const CLI::IsMember a_stage(std::vector<std::string>(kRunStageNames.begin(), kRunStageNames.end()));
  CLI::Option* from =
      command->add_option("--from", arguments->from, "Do this stage and those after it in any case")->check(a_stage);
  command->add_option("--until", arguments->until, "Stop after this stage")->check(a_stage);
  command->add_flag("--force", arguments->force, "Do every stage anew")->excludes(from);
  AddCommonOptions(*command, line);
  command->callback([arguments, &line] {
    line.action = [arguments, &line](Terminal& terminal) {
      const Config config = ResolveConfig(arguments->run.config, arguments->settings);
      arguments->run.stages.from = StageNamed(arguments->force ? std::string(kRunStageNames[0]) : arguments->from);
      arguments->run.stages.until = StageNamed(arguments->until);
      arguments->run.command = line.text;
      Say(Run(arguments->run, config, terminal), arguments->run.out, terminal);
    };
  });
}

}  // namespace glint
