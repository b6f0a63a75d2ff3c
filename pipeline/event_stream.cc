#include "pipeline/event_stream.h"

#include <nlohmann/json.hpp>

#include "pipeline/interrupt.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;
constexpr std::chrono::milliseconds kProgressEvery(100);

std::string Text(const Json& event) { return event.dump(-1, ' ', false, Json::error_handler_t::replace); }

}  // namespace

// One write a line: a reader never sees half of one while the next is on its way.
void EventStream::Write(const std::string& line) {
  std::fputs((line + "\n").c_str(), out_);
  std::fflush(out_);
}

void EventStream::BeginRun(const RunArguments& arguments) {
  std::lock_guard lock(mutex_);
  Write(Text({{"event", "begin"},
              {"glint", GLINT_VERSION},
              {"project", arguments.project.string()},
              {"out", arguments.out.string()}}));
}

void EventStream::EndRun(int code, const std::string& message, const RunArguments& arguments,
                         const RunSummary& summary) {
  std::lock_guard lock(mutex_);
  Json event = {{"event", "end"}, {"exit_code", code}};
  if (code != 0) {
    event["message"] = message;
  } else {
    event["outcome"] = summary.outcome;
    if (summary.num_faces > 0) {
      event["mesh"] = (arguments.out / "mesh.ply").string();
      event["vertices"] = summary.num_vertices;
      event["faces"] = summary.num_faces;
    }
  }
  Write(Text(event));
}

void EventStream::BeginStage(std::string_view name, size_t number, size_t count) {
  std::lock_guard lock(mutex_);
  stage_ = name;
  Write(Text({{"event", "stage"}, {"stage", name}, {"number", number}, {"of", count}}));
}

void EventStream::EndStage(std::string_view name, bool reused, double seconds) {
  std::lock_guard lock(mutex_);
  stage_.clear();
  Write(Text({{"event", "stage_end"}, {"stage", name}, {"reused", reused}, {"seconds", seconds}}));
}

void EventStream::WriteProgress() {
  const double seconds = std::chrono::duration<double>(Clock::now() - began_).count();
  Json event = {{"event", "progress"}, {"stage", stage_}, {"what", unit_}, {"done", done_}};
  if (total_ > 0) event["total"] = total_;
  event["seconds"] = seconds;
  if (const auto left = SecondsLeft(done_, total_, seconds)) event["seconds_left"] = *left;
  shown_ = Clock::now();
  Write(Text(event));
}

void EventStream::Begin(std::string_view what, size_t total) {
  std::lock_guard lock(mutex_);
  unit_ = what;
  total_ = total;
  done_ = 0;
  began_ = Clock::now();
  if (!unit_.empty()) WriteProgress();
}

void EventStream::Advance(size_t steps) {
  std::lock_guard lock(mutex_);
  done_ += steps;
  if (unit_.empty() || (done_ != total_ && Clock::now() - shown_ < kProgressEvery)) return;
  WriteProgress();
}

void EventStream::WriteMessage(const char* event, std::string_view message) {
  std::lock_guard lock(mutex_);
  Write(Text({{"event", event}, {"message", message}}));
}

void EventStream::Info(std::string_view message) { WriteMessage("info", message); }
void EventStream::Warn(std::string_view message) { WriteMessage("warning", message); }
bool EventStream::Cancelled() const { return InterruptSignal() != 0; }

}  // namespace glint
