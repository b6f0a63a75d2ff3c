// What a run says: kept for its report, and written to its log file on the way to the one who listens.
#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/run_listener.h"

namespace glint {

// Hands everything on to `listener`, which decides whether the run is cancelled; stages only to a RunListener.
// Thread-safe.
class RunLog : public RunListener {
 public:
  explicit RunLog(Progress& listener);
  ~RunLog() override;

  // From here on every message also goes, with the time, to `file`. Throws InputError if it cannot be opened.
  void WriteTo(const std::filesystem::path& file);

  void BeginStage(std::string_view name, size_t number, size_t count) override;
  void EndStage(std::string_view name, bool reused, double seconds) override;
  void Begin(std::string_view what, size_t total) override;
  void Advance(size_t steps = 1) override;
  void Info(std::string_view message) override;
  void Warn(std::string_view message) override;
  bool Cancelled() const override;

  void Finish() { Begin("", 0); }

  // How the run ended, for the file alone: the listener learns it from the exception.
  void Failed(std::string_view why);

  std::vector<std::string> Warnings() const;

 private:
  struct File;
  void FinishLocked();

  mutable std::mutex mutex_;
  Progress& listener_;
  RunListener* const stage_listener_;  // the same, if it wants to know of stages
  std::unique_ptr<File> file_;         // none until WriteTo()
  std::string unit_;
  size_t total_ = 0;
  std::chrono::steady_clock::time_point began_;
  std::vector<std::string> warnings_;
};

}  // namespace glint
