#include "pipeline/batch.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string_view>

#include "colmap/child_process.h"
#include "core/error.h"
#include "pipeline/ending.h"
#include "pipeline/interrupt.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

// The program that we are, as a program of its own.
std::vector<std::string> CommandFor(const BatchProject& project, const std::vector<std::string>& more) {
  const std::string program = std::filesystem::read_symlink("/proc/self/exe").string();
  std::vector<std::string> arguments = {program, "run", project.project.string(), "--out", project.out.string(),
                                        "--json"};
  const auto add = [&](const char* flag, const std::filesystem::path& path) {
    if (!path.empty()) arguments.insert(arguments.end(), {flag, path.string()});
  };
  add("--config", project.config);
  add("--lights", project.lights);
  add("--mesh", project.mesh);
  add("--images", project.images);
  add("--masks", project.masks);
  add("--normals", project.normals);
  for (const std::string& setting : project.settings) arguments.insert(arguments.end(), {"--set", setting});
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

// Follows one project's events (docs/events.md).
class Follower {
 public:
  Follower(BatchOutcome& outcome, bool events, RunListener& listener)
      : outcome_(outcome), events_(events), listener_(listener) {}

  void Take(std::string_view line) {
    Json event = Json::parse(line, nullptr, /*allow_exceptions=*/false);
    if (!event.is_object()) return;
    const std::string kind = event.value("event", "");
    if (kind == "end") TakeEnd(event);
    if (events_) {
      event["name"] = outcome_.name;
      fmt::print("{}\n", event.dump(-1, ' ', false, Json::error_handler_t::replace));
      std::fflush(stdout);
    } else {
      Relay(kind, event);
    }
  }

 private:
  void TakeEnd(const Json& event) {
    outcome_.outcome = event.value("outcome", event.value("message", ""));
    outcome_.faces = event.value("faces", size_t{0});
  }

  void Relay(const std::string& kind, const Json& event) {
    const std::string message = fmt::format("{}: {}", outcome_.name, event.value("message", ""));
    if (kind == "info") listener_.Info(message);
    if (kind == "warning") listener_.Warn(message);
    if (kind == "stage")
      listener_.BeginStage(outcome_.name + " " + event.value("stage", ""), event.value("number", size_t{0}),
                           event.value("of", size_t{0}));
    if (kind == "stage_end")
      listener_.EndStage(outcome_.name + " " + event.value("stage", ""), event.value("reused", false),
                         event.value("seconds", 0.0));
    if (kind == "progress") {
      const size_t done = event.value("done", size_t{0});
      if (done == 0 || done < done_) {
        listener_.Begin(event.value("what", ""), event.value("total", size_t{0}));
        done_ = 0;
      }
      listener_.Advance(done - done_);
      done_ = done;
    }
  }

  BatchOutcome& outcome_;
  const bool events_;
  RunListener& listener_;
  size_t done_ = 0;
};

void RunOne(const BatchProject& project, const std::vector<std::string>& more, bool events, RunListener& listener,
            BatchOutcome& outcome) {
  const auto start = std::chrono::steady_clock::now();
  Follower follower(outcome, events, listener);
  try {
    const ChildResult result = RunChild(
        CommandFor(project, more), {}, [&](std::string_view line) { follower.Take(line); }, listener);
    outcome.exit_code = result.end == ChildEnd::kExited ? result.code : 128 + result.code;
    if (outcome.outcome.empty()) outcome.outcome = "ended without a word; its log.txt may say more";
  } catch (const CancelledError&) {
    outcome.exit_code = 128 + InterruptSignal();
    outcome.outcome = "stopped on request";
  }
  outcome.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

std::string FirstLine(const std::string& text) { return text.substr(0, text.find('\n')); }

}  // namespace

std::vector<BatchOutcome> RunBatch(const std::vector<BatchProject>& projects, const std::vector<std::string>& more,
                                   bool events, RunListener& listener) {
  std::vector<BatchOutcome> outcomes;
  for (const BatchProject& project : projects) {
    BatchOutcome& outcome = outcomes.emplace_back();
    outcome.name = project.name;
    outcome.out = project.out;
    if (listener.Cancelled()) {
      outcome.exit_code = -1;
      outcome.outcome = "not started";
      continue;
    }
    listener.Info(fmt::format("{} ({} of {})", project.name, outcomes.size(), projects.size()));
    RunOne(project, more, events, listener, outcome);
  }
  return outcomes;
}

std::string BatchTable(const std::vector<BatchOutcome>& outcomes) {
  size_t width = 7;
  for (const BatchOutcome& outcome : outcomes) width = std::max(width, outcome.name.size());
  std::string table =
      fmt::format("{:<{}}  {:>4}  {:>9}  {:>9}  {}\n", "project", width, "exit", "seconds", "faces", "outcome");
  for (const BatchOutcome& outcome : outcomes)
    table += fmt::format("{:<{}}  {:>4}  {:>9.1f}  {:>9}  {}\n", outcome.name, width,
                         outcome.exit_code < 0 ? "-" : std::to_string(outcome.exit_code), outcome.seconds,
                         outcome.faces > 0 ? std::to_string(outcome.faces) : "-", FirstLine(outcome.outcome));
  const auto done = std::count_if(outcomes.begin(), outcomes.end(), [](const auto& o) { return o.exit_code == 0; });
  return table + fmt::format("{} of {} done\n", done, outcomes.size());
}

std::string BatchEvent(const std::vector<BatchOutcome>& outcomes) {
  Json event = {{"event", "batch_end"}, {"exit_code", BatchExitCode(outcomes)}, {"projects", Json::array()}};
  for (const BatchOutcome& outcome : outcomes)
    event["projects"].push_back({{"name", outcome.name},
                                 {"out", outcome.out.string()},
                                 {"exit_code", outcome.exit_code},
                                 {"outcome", outcome.outcome},
                                 {"faces", outcome.faces},
                                 {"seconds", outcome.seconds}});
  return event.dump(-1, ' ', false, Json::error_handler_t::replace);
}

int BatchExitCode(const std::vector<BatchOutcome>& outcomes) {
  const auto gravity = [](int code) {
    switch (code) {
      case kDone:
        return 0;
      case -1:
        return 1;
      case kNoResult:
        return 2;
      case kBadInput:
        return 3;
      case 128 + SIGINT:
      case 128 + SIGTERM:
        return 4;
      default:
        return 5;
    }
  };
  int gravest = kDone;
  for (const BatchOutcome& outcome : outcomes)
    if (gravity(outcome.exit_code) > gravity(gravest)) gravest = outcome.exit_code;
  return gravity(gravest) == 5 ? kBug : gravest;
}

}  // namespace glint
