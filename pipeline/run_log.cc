#include "pipeline/run_log.h"

#include <fmt/format.h>
#include <spdlog/sinks/basic_file_sink.h>
#include <spdlog/spdlog.h>

#include "core/error.h"

namespace glint {

struct RunLog::File {
  spdlog::logger logger;

  void Write(spdlog::level::level_enum level, std::string_view message) {
    logger.log(level, spdlog::string_view_t(message.data(), message.size()));
  }
};

RunLog::RunLog(Progress& listener) : listener_(listener), stage_listener_(dynamic_cast<RunListener*>(&listener)) {}
RunLog::~RunLog() = default;

void RunLog::WriteTo(const std::filesystem::path& file) {
  std::lock_guard lock(mutex_);
  try {
    file_ = std::make_unique<File>(
        File{{"file", std::make_shared<spdlog::sinks::basic_file_sink_st>(file.string(), /*truncate=*/false)}});
  } catch (const spdlog::spdlog_ex& e) {
    throw InputError(file.string(), "", std::string("the log cannot be written: ") + e.what());
  }
  file_->logger.set_pattern("%Y-%m-%d %H:%M:%S %L %v");
  file_->logger.flush_on(spdlog::level::info);
}

void RunLog::BeginStage(std::string_view name, size_t number, size_t count) {
  if (stage_listener_) stage_listener_->BeginStage(name, number, count);
}

void RunLog::EndStage(std::string_view name, bool reused, double seconds) {
  {
    std::lock_guard lock(mutex_);
    FinishLocked();
    if (file_)
      file_->Write(spdlog::level::info, reused ? fmt::format("{}: taken from the earlier run", name)
                                               : fmt::format("{}: done in {:.1f} s", name, seconds));
  }
  if (stage_listener_) stage_listener_->EndStage(name, reused, seconds);
}

void RunLog::Begin(std::string_view what, size_t total) {
  {
    std::lock_guard lock(mutex_);
    FinishLocked();
    unit_ = what;
    total_ = total;
    began_ = std::chrono::steady_clock::now();
  }
  listener_.Begin(what, total);
}

void RunLog::Advance(size_t steps) { listener_.Advance(steps); }

void RunLog::FinishLocked() {
  if (unit_.empty()) return;
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - began_;
  const std::string count = total_ > 0 ? fmt::format(" ({})", total_) : "";
  if (file_) file_->Write(spdlog::level::info, fmt::format("{}{}: {:.1f} s", unit_, count, seconds.count()));
  unit_.clear();
}

void RunLog::Info(std::string_view message) {
  {
    std::lock_guard lock(mutex_);
    if (file_) file_->Write(spdlog::level::info, message);
  }
  listener_.Info(message);
}

void RunLog::Warn(std::string_view message) {
  {
    std::lock_guard lock(mutex_);
    warnings_.emplace_back(message);
    if (file_) file_->Write(spdlog::level::warn, message);
  }
  listener_.Warn(message);
}

bool RunLog::Cancelled() const { return listener_.Cancelled(); }

void RunLog::Failed(std::string_view why) {
  std::lock_guard lock(mutex_);
  if (file_) file_->Write(spdlog::level::err, why);
}

std::vector<std::string> RunLog::Warnings() const {
  std::lock_guard lock(mutex_);
  return warnings_;
}

}  // namespace glint
