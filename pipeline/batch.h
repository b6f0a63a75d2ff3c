// Many projects in one go, one after the other; one that fails does not stop the others.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/batch_file.h"
#include "pipeline/run_listener.h"

namespace glint {

struct BatchOutcome {
  std::string name;
  std::filesystem::path out;
  int exit_code = 0;    // -1: not started
  std::string outcome;  // "done", "nothing to do", or why there is no result
  size_t faces = 0;
  double seconds = 0;
};

// Runs every project as a program of its own with `more` as further arguments. What they tell goes to `listener`, or,
// as events with the project's "name", to standard output if `events`. Once cancelled, the rest is not started.
std::vector<BatchOutcome> RunBatch(const std::vector<BatchProject>& projects, const std::vector<std::string>& more,
                                   bool events, RunListener& listener);

// A line a project.
std::string BatchTable(const std::vector<BatchOutcome>& outcomes);

// The last event of a batch.
std::string BatchEvent(const std::vector<BatchOutcome>& outcomes);

// Of the whole: 0 only if every project is done; of several failures the gravest: a bug or a crash (1), being asked to
// stop (128 + signal), bad input (2), no honest result (3).
int BatchExitCode(const std::vector<BatchOutcome>& outcomes);

}  // namespace glint
