// Ctrl-C and kill as a wish that stages see between units of work.
#pragma once

namespace glint {

// While it lives, SIGINT and SIGTERM ask to stop instead of ending the program at once; a second one ends it.
// At most one at a time.
class InterruptGuard {
 public:
  InterruptGuard();
  ~InterruptGuard();
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;
};

// The signal that asked to stop, 0: none.
int InterruptSignal();

}  // namespace glint
