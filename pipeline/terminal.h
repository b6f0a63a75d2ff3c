// What a person at the shell, or a log, sees of a run.
#pragma once

#include <chrono>
#include <cstddef>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>

#include "pipeline/run_listener.h"

namespace glint {

enum class Verbosity { kQuiet, kNormal };

// Writes to standard error: on a terminal a bar for the running unit of work, plain lines elsewhere; kQuiet leaves
// only warnings. Cancelled() follows InterruptSignal(). Thread-safe.
class Terminal : public RunListener {
 public:
  explicit Terminal(Verbosity verbosity);
  ~Terminal() override;

  void BeginStage(std::string_view name, size_t number, size_t count) override;
  void EndStage(std::string_view name, bool reused, double seconds) override;
  void Begin(std::string_view what, size_t total) override;
  void Advance(size_t steps = 1) override;
  void Info(std::string_view message) override;
  void Warn(std::string_view message) override;
  void Error(std::string_view message);
  bool Cancelled() const override;

  // Ends the running unit of work: the bar makes room for its closing line.
  void Finish();

 private:
  using Clock = std::chrono::steady_clock;
  struct Screen;

  void FinishLocked();
  std::string BarLine() const;
  void Draw();
  void ClearBar();

  mutable std::mutex mutex_;
  std::unique_ptr<Screen> screen_;
  bool quiet_;
  bool draw_bars_;
  bool bar_on_screen_ = false;
  std::string stage_;  // "[2/6 detect] "; empty outside of a run
  std::string unit_;
  size_t total_ = 0;
  size_t done_ = 0;
  Clock::time_point began_;
  Clock::time_point shown_;
};

}  // namespace glint
