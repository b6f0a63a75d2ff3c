// The program `glint`: reads the command line, runs one command, and turns what went wrong into an exit code.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <cstdio>
#include <exception>
#include <opencv2/core/utility.hpp>
#include <string>
#include <string_view>

#include "core/cancel_scope.h"
#include "core/parallel.h"
#include "pipeline/commands/command.h"
#include "pipeline/ending.h"
#include "pipeline/interrupt.h"
#include "pipeline/terminal.h"
#include "pipeline/usage_error.h"

namespace {

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
  glint::AddCompletionCommand(app, line);
}

int RunAction(const glint::CommandLine& line) {
  glint::Terminal terminal(line.quiet ? glint::Verbosity::kQuiet : glint::Verbosity::kNormal);
  const glint::InterruptGuard interrupts;
  const glint::CancelScope cancelled(terminal);
  const glint::ThreadLimit threads(line.threads);
  cv::setNumThreads(1);  // images are worked on in parallel; OpenCV's own threads would heed no limit
  try {
    line.action(terminal);
    terminal.Finish();
    return line.exit_code;
  } catch (...) {
    const glint::Ending ending = glint::EndingOf(std::current_exception());
    if (!ending.message.empty()) terminal.Error(ending.message);
    return ending.exit_code;
  }
}

int Start(int argc, char** argv) {
  CLI::App app(kAbout, "glint");
  glint::CommandLine line;
  for (int i = 0; i < argc; ++i) line.text += (i > 0 ? " " : "") + Quoted(argv[i]);
  DeclareCommands(app, line);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0) return app.exit(e);  // --help, --version
    std::fputs(glint::DescribeUsageError(app, e, {argv + 1, argv + argc}).c_str(), stderr);
    return glint::kBadInput;
  }
  return RunAction(line);
}

}  // namespace

int main(int argc, char** argv) {
  // Only what goes wrong before there is a terminal to tell it on gets here.
  try {
    return Start(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
  } catch (...) {
    std::fputs("error: unknown\n", stderr);
  }
  return glint::kBug;
}
