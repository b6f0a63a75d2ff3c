// Runs another program to its end and watches it.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/progress.h"

namespace glint {

struct ChildOptions {
  std::vector<std::pair<std::string, std::string>> environment;  // set beside what we have
  std::filesystem::path log;                                     // all that it prints is appended; empty: nowhere
  // Neither a byte printed nor processor time used for so long: it hangs. 0: no limit.
  double stall_limit_s = 0;
  double time_limit_s = 0;  // 0: no limit
};

enum class ChildEnd { kExited, kSignal, kStalled, kTooLong };

struct ChildResult {
  ChildEnd end = ChildEnd::kExited;
  int code = 0;      // exit code, or the signal that ended it
  std::string tail;  // the last lines that it printed

  bool ok() const { return end == ChildEnd::kExited && code == 0; }
};

// `command`: the program's file and its arguments. `on_line` is called with each line of its standard output and error.
// The program runs in a process group of its own, which is ended when a limit is passed or the user asks to stop; it
// ends with us even if we are killed. Throws CancelledError, and InputError if the program or the log cannot be opened.
ChildResult RunChild(const std::vector<std::string>& command, const ChildOptions& options,
                     const std::function<void(std::string_view)>& on_line, const Progress& progress);

// The executable file that a shell would run for `name`; empty if there is none.
std::filesystem::path FindProgram(const std::string& name);

}  // namespace glint
