// How a command ended, as an exit code and a sentence.
#pragma once

#include <exception>
#include <string>

namespace glint {

// 0 done, 2 bad input or configuration, 3 no honest result, 1 a bug, 128 + signal when asked to stop.
enum ExitCode { kDone = 0, kBug = 1, kBadInput = 2, kNoResult = 3 };

struct Ending {
  int exit_code = kDone;
  std::string message;
};

// What an exception means to the person at the shell.
Ending EndingOf(const std::exception_ptr& exception);

}  // namespace glint
