#include "pipeline/commands/command.h"

#include <CLI/CLI.hpp>

namespace glint {

void AddCommonOptions(CLI::App& command, CommandLine& line) {
  command.add_option("--threads", line.threads, "How many threads to use; 0: one a core")->check(CLI::Range(0, 4096));
  command.add_flag("-q,--quiet", line.quiet, "Say nothing but warnings and errors");
}

}  // namespace glint
