// A run for other programs: one JSON object a line (docs/events.md).
#pragma once

#include <chrono>
#include <cstdio>
#include <mutex>
#include <string>
#include <string_view>

#include "pipeline/run.h"
#include "pipeline/run_listener.h"

namespace glint {

// Writes to `out` and flushes every line. Thread-safe. Cancelled() follows InterruptSignal().
class EventStream : public RunListener {
 public:
  explicit EventStream(std::FILE* out) : out_(out) {}

  void BeginRun(const RunArguments& arguments);
  // `code`: what the program exits with; `message`: why it is not 0.
  void EndRun(int code, const std::string& message, const RunArguments& arguments, const RunSummary& summary);

  void BeginStage(std::string_view name, size_t number, size_t count) override;
  void EndStage(std::string_view name, bool reused, double seconds) override;
  void Begin(std::string_view what, size_t total) override;
  void Advance(size_t steps = 1) override;
  void Info(std::string_view message) override;
  void Warn(std::string_view message) override;
  bool Cancelled() const override;

 private:
  using Clock = std::chrono::steady_clock;
  void Write(const std::string& line);
  void WriteProgress();
  void WriteMessage(const char* event, std::string_view message);

  std::FILE* out_;
  std::mutex mutex_;
  std::string stage_, unit_;
  size_t total_ = 0, done_ = 0;
  Clock::time_point began_, shown_;
};

}  // namespace glint
