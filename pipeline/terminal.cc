#include "pipeline/terminal.h"

#include <fmt/format.h>
#include <spdlog/sinks/basic_file_sink.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <vector>

#include "core/error.h"
#include "pipeline/interrupt.h"

namespace glint {
namespace {

constexpr int kBarCells = 30;
constexpr std::chrono::milliseconds kRedrawEvery(100);
constexpr std::chrono::seconds kPlainLineEvery(15);

double Seconds(std::chrono::steady_clock::duration d) { return std::chrono::duration<double>(d).count(); }

std::string Duration(double seconds) {
  if (seconds < 60) return fmt::format("{:.1f} s", seconds);
  return fmt::format("{} min {:02} s", static_cast<int>(seconds) / 60, static_cast<int>(seconds) % 60);
}

std::string Bar(size_t done, size_t total) {
  const int filled = static_cast<int>(kBarCells * std::min(done, total) / total);
  return fmt::format("[{:#<{}}{:.<{}}]", "", filled, "", kBarCells - filled);
}

}  // namespace

// The screen and, once asked for, a log file; each message goes to both.
struct Terminal::Sinks {
  spdlog::logger screen{"glint", std::make_shared<spdlog::sinks::stderr_color_sink_st>()};
  std::unique_ptr<spdlog::logger> file;

  void Log(spdlog::level::level_enum level, std::string_view message) {
    screen.log(level, spdlog::string_view_t(message.data(), message.size()));
    if (file) file->log(level, spdlog::string_view_t(message.data(), message.size()));
  }
};

Terminal::Terminal(Verbosity verbosity)
    : sinks_(std::make_unique<Sinks>()),
      quiet_(verbosity == Verbosity::kQuiet),
      draw_bars_(!quiet_ && isatty(STDERR_FILENO) == 1) {
  sinks_->screen.set_level(quiet_ ? spdlog::level::warn : spdlog::level::info);
  sinks_->screen.set_pattern("%^%v%$");
}

Terminal::~Terminal() { ClearBar(); }

void Terminal::LogTo(const std::filesystem::path& file) {
  std::lock_guard lock(mutex_);
  try {
    sinks_->file = std::make_unique<spdlog::logger>(
        "file", std::make_shared<spdlog::sinks::basic_file_sink_st>(file.string(), /*truncate=*/false));
  } catch (const spdlog::spdlog_ex& e) {
    throw InputError(file.string(), "", std::string("the log cannot be written: ") + e.what());
  }
  sinks_->file->set_pattern("%Y-%m-%d %H:%M:%S %L %v");
  sinks_->file->flush_on(spdlog::level::info);
}

void Terminal::Begin(std::string_view what, size_t total) {
  std::lock_guard lock(mutex_);
  FinishLocked();
  unit_ = what;
  total_ = total;
  done_ = 0;
  began_ = shown_ = Clock::now();
  if (draw_bars_) {
    Draw();
  }
}

void Terminal::Advance(size_t steps) {
  std::lock_guard lock(mutex_);
  done_ += steps;
  const auto now = Clock::now();
  if (draw_bars_) {
    if (now - shown_ < kRedrawEvery && done_ != total_) return;
    shown_ = now;
    Draw();
  } else if (now - shown_ >= kPlainLineEvery && !unit_.empty()) {
    shown_ = now;
    sinks_->Log(spdlog::level::info,
                total_ > 0 ? fmt::format("{}: {} of {}", unit_, done_, total_) : fmt::format("{}: {}", unit_, done_));
  }
}

void Terminal::Info(std::string_view message) {
  std::lock_guard lock(mutex_);
  ClearBar();
  sinks_->Log(spdlog::level::info, message);
}

void Terminal::Warn(std::string_view message) {
  std::lock_guard lock(mutex_);
  ClearBar();
  warnings_.emplace_back(message);
  sinks_->Log(spdlog::level::warn, "warning: " + std::string(message));
}

void Terminal::Error(std::string_view message) {
  std::lock_guard lock(mutex_);
  ClearBar();
  unit_.clear();
  sinks_->Log(spdlog::level::err, "error: " + std::string(message));
}

bool Terminal::Cancelled() const { return InterruptSignal() != 0; }

void Terminal::Finish() {
  std::lock_guard lock(mutex_);
  FinishLocked();
}

std::vector<std::string> Terminal::Warnings() const {
  std::lock_guard lock(mutex_);
  return warnings_;
}

void Terminal::FinishLocked() {
  ClearBar();
  if (unit_.empty()) return;
  const std::string count = total_ > 0 ? fmt::format(" ({})", total_) : "";
  sinks_->Log(spdlog::level::info, fmt::format("{}{}: {}", unit_, count, Duration(Seconds(Clock::now() - began_))));
  unit_.clear();
}

void Terminal::Draw() {
  std::string line = unit_;
  if (total_ > 0) {
    line += fmt::format(" {} {}/{}", Bar(done_, total_), std::min(done_, total_), total_);
    const double elapsed = Seconds(Clock::now() - began_);
    if (done_ > 0 && done_ < total_ && elapsed > 2)
      line += fmt::format(", {} left",
                          Duration(elapsed * static_cast<double>(total_ - done_) / static_cast<double>(done_)));
  } else {
    line += " ...";
  }
  fmt::print(stderr, "\r\x1b[K{}", line);
  std::fflush(stderr);
  bar_on_screen_ = true;
}

void Terminal::ClearBar() {
  if (!bar_on_screen_) return;
  fmt::print(stderr, "\r\x1b[K");
  std::fflush(stderr);
  bar_on_screen_ = false;
}

}  // namespace glint
