// Stopping work that does not ask by itself whether it should.
#pragma once

#include "core/progress.h"

namespace glint {

// While it lives, all parallel loops (core/parallel.h) that this thread begins, and those within them, throw
// CancelledError between two chunks once `progress` is cancelled. `progress` must outlive it.
class CancelScope {
 public:
  explicit CancelScope(const Progress& progress);
  ~CancelScope();
  CancelScope(const CancelScope&) = delete;
  CancelScope& operator=(const CancelScope&) = delete;

  // What the innermost scope of this thread asks; Progress::Silent() outside of all. Loops that do not go through
  // core/parallel.h take it before they begin, and ask it in their bodies.
  static const Progress& Current();

 private:
  const Progress* const outer_;
};

}  // namespace glint
