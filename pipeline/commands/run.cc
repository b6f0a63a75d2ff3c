// glint run: the main job, for one project or for a list of them.
#include "pipeline/run.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/error.h"
#include "pipeline/batch.h"
#include "pipeline/commands/command.h"
#include "pipeline/config.h"
#include "pipeline/ending.h"
#include "pipeline/event_stream.h"
#include "pipeline/masks_back.h"
#include "pipeline/terminal.h"

namespace glint {
namespace {

struct Arguments {
  RunArguments run;
  std::filesystem::path batch;
  std::string from, until;
  bool force = false;
  bool masks_back = false;
  bool json = false;
  std::vector<std::string> settings;
};

std::optional<RunStage> StageNamed(const std::string& name) {
  const auto found = std::find(kRunStageNames.begin(), kRunStageNames.end(), name);
  if (found == kRunStageNames.end()) return std::nullopt;
  return static_cast<RunStage>(found - kRunStageNames.begin());
}

RunSummary RunOne(const Arguments& arguments, Progress& progress) {
  Config config = ResolveConfig(arguments.run.config, arguments.settings);
  if (arguments.masks_back)
    config.photos.feature_masks =
        KeepMasksForFeatures(arguments.run.project, arguments.run.out, arguments.run.stages.from == RunStage::kPhotos)
            .string();
  return Run(arguments.run, config, progress);
}

void RunWithEvents(const Arguments& arguments) {
  EventStream events(stdout);
  events.BeginRun(arguments.run);
  try {
    const RunSummary summary = RunOne(arguments, events);
    events.EndRun(kDone, "", arguments.run, summary);
  } catch (...) {
    const Ending ending = EndingOf(std::current_exception());
    events.EndRun(ending.exit_code, ending.message, arguments.run, {});
    throw;
  }
}

void RunForPeople(const Arguments& arguments, Terminal& terminal) {
  const RunSummary summary = RunOne(arguments, terminal);
  const std::string out = arguments.run.out.string();
  if (summary.outcome == "nothing to do")
    terminal.Info(
        fmt::format("{}: nothing to do: program, project and options are those that made what is there "
                    "(--force does it anew)",
                    out));
  else if (summary.outcome == "done")
    terminal.Info(fmt::format("{}: mesh.ply ({} faces), sdf.vdb, report.html", out, summary.num_faces));
  else
    terminal.Info(fmt::format("{}: {}; the same command without --until goes on", out, summary.outcome));
}

int RunMany(const Arguments& arguments, int threads, Terminal& terminal) {
  std::vector<std::string> more = {"--threads", std::to_string(threads)};
  if (!arguments.from.empty()) more.insert(more.end(), {"--from", arguments.from});
  if (!arguments.until.empty()) more.insert(more.end(), {"--until", arguments.until});
  if (arguments.force) more.push_back("--force");
  for (const std::string& setting : arguments.settings) more.insert(more.end(), {"--set", setting});
  const std::vector<BatchOutcome> outcomes = RunBatch(ReadBatchFile(arguments.batch), more, arguments.json, terminal);
  terminal.Finish();
  fmt::print("{}", arguments.json ? BatchEvent(outcomes) + "\n" : BatchTable(outcomes));
  terminal.ThrowIfCancelled();
  return BatchExitCode(outcomes);
}

void DeclareStageOptions(CLI::App& command, Arguments& arguments) {
  const CLI::IsMember a_stage(std::vector<std::string>(kRunStageNames.begin(), kRunStageNames.end()));
  CLI::Option* from =
      command.add_option("--from", arguments.from, "Do this stage and those after it in any case")->check(a_stage);
  command.add_option("--until", arguments.until, "Stop after this stage")->check(a_stage);
  command.add_flag("--force", arguments.force, "Do every stage anew, COLMAP's too")->excludes(from);
}

// What belongs to one project; a batch file says it for each of its projects.
void DeclareProjectOptions(CLI::App& command, Arguments& arguments) {
  RunArguments& run = arguments.run;
  CLI::Option* batch = command.add_option("--batch", arguments.batch, "YAML file with a list of projects to run");
  for (CLI::Option* option :
       {command.add_option("PROJECT", run.project, "A COLMAP project, a folder of photographs, or a film"),
        command.add_option("-o,--out", run.out, "Folder for the results"),
        command.add_option("--config", run.config, "YAML file with options to change (see glint config)"),
        command.add_option("--lights", run.lights, "JSON file with the lights"),
        command.add_option("--mesh", run.mesh, "Start from this mesh, in the project's frame, not from the points"),
        command.add_option("--images", run.images, "Folder of the images, if not in the project"),
        command.add_option("--masks", run.masks, "Folder of masks (IMAGE.png, 0 is ignored), if not in the project"),
        command.add_option("--normals", run.normals,
                           "Folder of normal maps of the photographs (IMAGE.png, or COLMAP's)")})
    option->excludes(batch);
  command
      .add_flag("--masks-back", arguments.masks_back,
                "Run COLMAP again, with no features on the highlights that an earlier run in OUT found")
      ->excludes(batch);
  command
      .add_option_function<std::string>(
          "--box", [&arguments](const std::string& box) { arguments.settings.push_back("seed.object.box=" + box); },
          "The object is in this box of the project's frame, --box=X,Y,Z,SX,SY,SZ: centre and size")
      ->excludes(batch);
}

}  // namespace

void AddRunCommand(CLI::App& app, CommandLine& line) {
  CLI::App* command = app.add_subcommand("run", "The main job: a COLMAP project, photographs or a film in, a mesh out");
  auto arguments = std::make_shared<Arguments>();
  DeclareProjectOptions(*command, *arguments);
  command->add_option("--set", arguments->settings, "Change one option: section.option=value")->allow_extra_args(false);
  DeclareStageOptions(*command, *arguments);
  command->add_flag("--json", arguments->json, "Tell what happens as JSON, one event a line, on standard output");
  AddCommonOptions(*command, line);
  command->callback([arguments, &line] {
    if (arguments->batch.empty() && arguments->run.project.empty()) throw CLI::RequiredError("PROJECT or --batch");
    if (arguments->batch.empty() && arguments->run.out.empty()) throw CLI::RequiredError("--out");
    line.quiet |= arguments->json;
    line.action = [arguments, &line](Terminal& terminal) {
      arguments->run.stages.from = StageNamed(arguments->force ? std::string(kRunStageNames[0]) : arguments->from);
      arguments->run.stages.until = StageNamed(arguments->until);
      arguments->run.command = line.text;
      if (!arguments->batch.empty()) {
        line.exit_code = RunMany(*arguments, line.threads, terminal);
      } else if (arguments->json) {
        RunWithEvents(*arguments);
      } else {
        RunForPeople(*arguments, terminal);
      }
    };
  });
}

}  // namespace glint
