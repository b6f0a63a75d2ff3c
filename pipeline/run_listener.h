// Who follows a run: besides the progress of each unit of work, its stages.
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

#include "core/progress.h"

namespace glint {

class RunListener : public Progress {
 public:
  // Stage `number` (from 1) of `count` begins.
  virtual void BeginStage(std::string_view name, size_t number, size_t count) = 0;
  // It is over; `reused`: taken from an earlier run.
  virtual void EndStage(std::string_view name, bool reused, double seconds) = 0;
};

// A guess at the time that the rest of a unit of work takes, from its steps so far; nothing while there is no ground.
inline std::optional<double> SecondsLeft(size_t done, size_t total, double seconds_so_far) {
  constexpr double kTooEarly = 1;
  if (done == 0 || done >= total || seconds_so_far < kTooEarly) return std::nullopt;
  return seconds_so_far * static_cast<double>(total - done) / static_cast<double>(done);
}

}  // namespace glint
