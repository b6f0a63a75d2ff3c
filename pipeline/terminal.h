// What a person at the shell, or a log, sees of a run.
#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "core/progress.h"

namespace glint {

enum class Verbosity { kQuiet, kNormal };

// Writes to standard error: on a terminal a bar for the running unit of work, plain lines elsewhere; kQuiet leaves
// only warnings. Cancelled() follows InterruptSignal(). Thread-safe.
class Terminal : public Progress {
 public:
  explicit Terminal(Verbosity verbosity);
  ~Terminal() override;

  // From here on every message also goes, with the time, to a log file. Throws InputError if it cannot be opened.
  void LogTo(const std::filesystem::path& file);

  void Begin(std::string_view what, size_t total) override;
  void Advance(size_t steps = 1) override;
  void Info(std::string_view message) override;
  void Warn(std::string_view message) override;
  void Error(std::string_view message);
  bool Cancelled() const override;

  // Ends the running unit of work: the bar makes room for its closing line.
  void Finish();

  // Every warning so far, for the report.
  std::vector<std::string> Warnings() const;

 private:
  using Clock = std::chrono::steady_clock;
  struct Sinks;

  void FinishLocked();
  void Draw();
  void ClearBar();

  mutable std::mutex mutex_;
  std::unique_ptr<Sinks> sinks_;
  bool quiet_;
  bool draw_bars_;
  bool bar_on_screen_ = false;
  std::string unit_;
  size_t total_ = 0;
  size_t done_ = 0;
  Clock::time_point began_;
  Clock::time_point shown_;
  std::vector<std::string> warnings_;
};

}  // namespace glint
