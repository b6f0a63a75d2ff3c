// The program `glint`: reads the command line, runs one command, and turns what went wrong into an exit code:
// 0 done, 2 bad input or configuration, 3 no honest result, 1 a bug, 128 + signal when asked to stop.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <exception>
#include <filesystem>
#include <new>
#include <opencv2/core/utility.hpp>
#include <string>
#include <string_view>

#include "core/error.h"
#include "core/parallel.h"
#include "pipeline/commands/command.h"
#include "pipeline/interrupt.h"
#include "pipeline/terminal.h"

namespace {

enum ExitCode { kDone = 0, kBug = 1, kBadInput = 2, kNoResult = 3 };

constexpr const char* kAbout =
    "Glint turns specular highlights in the photographs of a COLMAP project into measurements of the surface,\n"
    "and refines the mesh with them.";

// An argument as a shell reads it back.
std::string Quoted(const std::string& argument) {
  const auto plain = [](unsigned char c) {
    return std::isalnum(c) || std::string_view("_-./=:,+@%").find(c) != std::string_view::npos;
  };
  if (!argument.empty() && std::all_of(argument.begin(), argument.end(), plain)) return argument;
  std::string quoted = "'";
  for (char c : argument) quoted += c == '\'' ? "'\\''" : std::string(1, c);
  return quoted + "'";
}

void DeclareCommands(CLI::App& app, glint::CommandLine& line) {
  app.set_version_flag("--version", "glint " GLINT_VERSION);
  app.require_subcommand(1);
  app.fallthrough(false);
  glint::AddRunCommand(app, line);
  glint::AddSynthCommand(app, line);
  glint::AddDetectCommand(app, line);
  glint::AddLightCommand(app, line);
  glint::AddSdfCommand(app, line);
  glint::AddMeshCommand(app, line);
  glint::AddRenderCommand(app, line);
  glint::AddCompareCommand(app, line);
  glint::AddInspectCommand(app, line);
  glint::AddConfigCommand(app, line);
}

// OpenCV says it in its own way.
bool IsOutOfMemory(const std::exception& e) {
  const auto* opencv = dynamic_cast<const cv::Exception*>(&e);
  return dynamic_cast<const std::bad_alloc*>(&e) || (opencv && opencv->code == cv::Error::StsNoMem);
}

int RunAction(const glint::CommandLine& line) {
  glint::Terminal terminal(line.quiet ? glint::Verbosity::kQuiet : glint::Verbosity::kNormal);
  const glint::InterruptGuard interrupts;
  const glint::ThreadLimit threads(line.threads);
  cv::setNumThreads(1);  // images are worked on in parallel; OpenCV's own threads would heed no limit
  try {
    line.action(terminal);
    terminal.Finish();
    return kDone;
  } catch (const glint::InputError& e) {
    terminal.Error(e.what());
    return kBadInput;
  } catch (const glint::NoResultError& e) {
    terminal.Error(e.what());
    return kNoResult;
  } catch (const glint::CancelledError&) {
    terminal.Error("stopped on request; finished stages are kept");
    return 128 + glint::InterruptSignal();
  } catch (const std::filesystem::filesystem_error& e) {
    terminal.Error(e.what());
    return kBadInput;
  } catch (const std::exception& e) {
    if (IsOutOfMemory(e)) {
      terminal.Error("out of memory: choose larger voxels or smaller images");
      return kBadInput;
    }
    terminal.Error(std::string("this is a bug in Glint, please report it: ") + e.what());
    return kBug;
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(kAbout, "glint");
  glint::CommandLine line;
  for (int i = 0; i < argc; ++i) line.text += (i > 0 ? " " : "") + Quoted(argv[i]);
  DeclareCommands(app, line);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? kDone : kBadInput;
  }
  return RunAction(line);
}
