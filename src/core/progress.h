// How stages tell what they are doing, without logging or drawing themselves.
#pragma once

#include <cstddef>
#include <string_view>

namespace glint {

// Receives the reports of one stage. All functions may be called from several threads at once.
// The default implementation is silent; pipeline/ draws bars and writes logs.
class Progress {
 public:
  virtual ~Progress() = default;

  // A unit of work named `what` begins that will advance `total` times (0: unknown). Empty: the last one is done.
  virtual void Begin(std::string_view what, size_t total);
  virtual void Advance(size_t steps = 1);
  virtual void Info(std::string_view message);
  virtual void Warn(std::string_view message);

  // True once the user has asked to stop.
  virtual bool Cancelled() const;

  // Throws CancelledError once the user has asked to stop. Stages call it between units of work.
  void ThrowIfCancelled() const;

  // A progress that says nothing.
  static Progress& Silent();
};

}  // namespace glint
