// What every command of the program shares.
#pragma once

#include <functional>
#include <string>

namespace CLI {
class App;
}

namespace glint {

class Terminal;

// Filled by the parser: what to do once the whole command line is known to be right.
struct CommandLine {
  int threads = 0;  // 0: as many as the machine has
  bool quiet = false;
  std::string text;  // as typed
  std::function<void(Terminal&)> action;
  int exit_code = 0;  // of an action that has an ending of its own and throws nothing
};

// Each declares one command: its arguments, its help, and its action.
void AddCompareCommand(CLI::App& app, CommandLine& line);
void AddCompletionCommand(CLI::App& app, CommandLine& line);
void AddConfigCommand(CLI::App& app, CommandLine& line);
void AddDetectCommand(CLI::App& app, CommandLine& line);
void AddInspectCommand(CLI::App& app, CommandLine& line);
void AddLightCommand(CLI::App& app, CommandLine& line);
void AddMeshCommand(CLI::App& app, CommandLine& line);
void AddRenderCommand(CLI::App& app, CommandLine& line);
void AddRunCommand(CLI::App& app, CommandLine& line);
void AddSdfCommand(CLI::App& app, CommandLine& line);
void AddSynthCommand(CLI::App& app, CommandLine& line);

// --threads and --quiet.
void AddCommonOptions(CLI::App& command, CommandLine& line);

}  // namespace glint
