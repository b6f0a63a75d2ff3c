#include "pipeline/terminal.h"

#include <fmt/format.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

#include "pipeline/interrupt.h"

namespace glint {
namespace {

constexpr int kBarCells = 30;
constexpr size_t kDefaultColumns = 79;
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

struct Terminal::Screen {
  spdlog::logger logger{"glint", std::make_shared<spdlog::sinks::stderr_color_sink_st>()};

  void Log(spdlog::level::level_enum level, std::string_view message) {
    logger.log(level, spdlog::string_view_t(message.data(), message.size()));
  }
};

Terminal::Terminal(Verbosity verbosity)
    : screen_(std::make_unique<Screen>()),
      quiet_(verbosity == Verbosity::kQuiet),
      draw_bars_(!quiet_ && isatty(STDERR_FILENO) == 1) {
  screen_->logger.set_level(quiet_ ? spdlog::level::warn : spdlog::level::info);
  screen_->logger.set_pattern("%^%v%$");
}

Terminal::~Terminal() { ClearBar(); }

void Terminal::BeginStage(std::string_view name, size_t number, size_t count) {
  std::lock_guard lock(mutex_);
  FinishLocked();
  stage_ = fmt::format("[{}/{} {}] ", number, count, name);
}

void Terminal::EndStage(std::string_view name, bool reused, double) {
  std::lock_guard lock(mutex_);
  FinishLocked();
  if (reused) screen_->Log(spdlog::level::info, fmt::format("{}: taken from the earlier run", name));
  stage_.clear();
}

void Terminal::Begin(std::string_view what, size_t total) {
  std::lock_guard lock(mutex_);
  FinishLocked();
  unit_ = what;
  total_ = total;
  done_ = 0;
  began_ = shown_ = Clock::now();
  if (draw_bars_ && !unit_.empty()) Draw();
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
    screen_->Log(spdlog::level::info,
                 total_ > 0 ? fmt::format("{}: {} of {}", unit_, done_, total_) : fmt::format("{}: {}", unit_, done_));
  }
}

void Terminal::Info(std::string_view message) {
  std::lock_guard lock(mutex_);
  ClearBar();
  screen_->Log(spdlog::level::info, message);
}

void Terminal::Warn(std::string_view message) {
  std::lock_guard lock(mutex_);
  ClearBar();
  screen_->Log(spdlog::level::warn, "warning: " + std::string(message));
}

void Terminal::Error(std::string_view message) {
  std::lock_guard lock(mutex_);
  ClearBar();
  unit_.clear();
  screen_->Log(spdlog::level::err, "error: " + std::string(message));
}

bool Terminal::Cancelled() const { return InterruptSignal() != 0; }

void Terminal::Finish() {
  std::lock_guard lock(mutex_);
  FinishLocked();
}

void Terminal::FinishLocked() {
  ClearBar();
  if (unit_.empty()) return;
  const std::string count = total_ > 0 ? fmt::format(" ({})", total_) : "";
  screen_->Log(spdlog::level::info, fmt::format("{}{}: {}", unit_, count, Duration(Seconds(Clock::now() - began_))));
  unit_.clear();
}

// As wide as the screen at most: a line that wraps cannot be drawn over.
std::string Terminal::BarLine() const {
  std::string line = stage_ + unit_;
  if (total_ == 0) {
    line += " ...";
  } else {
    line += fmt::format(" {} {}/{}", Bar(done_, total_), std::min(done_, total_), total_);
    if (const auto left = SecondsLeft(done_, total_, Seconds(Clock::now() - began_)))
      line += fmt::format(", {} left", Duration(*left));
  }
  winsize size = {};
  const bool known = ::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 1;
  return line.substr(0, known ? size.ws_col - 1u : kDefaultColumns);
}

void Terminal::Draw() {
  fmt::print(stderr, "\r\x1b[K{}", BarLine());
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
