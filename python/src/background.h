// Long work beside the interpreter: the GIL is free, Ctrl-C is heard, progress is told.
#pragma once

#include <pybind11/pybind11.h>

#include <atomic>
#include <chrono>
#include <deque>
#include <functional>
#include <future>
#include <mutex>
#include <string>
#include <string_view>
#include <type_traits>

#include "core/cancel_scope.h"
#include "core/progress.h"

namespace glint::python {

namespace py = pybind11;

// What the stages say, from whatever thread, until the interpreter's thread fetches it.
class Reports : public Progress {
 public:
  struct Event {
    std::string kind;  // "begin", "advance", "end", "info", "warning"
    std::string text;  // the message, or the name of the unit of work
    size_t done = 0;
    size_t total = 0;  // 0: unknown
  };

  void Begin(std::string_view what, size_t total) override;
  void Advance(size_t steps = 1) override;
  void Info(std::string_view message) override;
  void Warn(std::string_view message) override;
  bool Cancelled() const override { return cancelled_; }

  void Cancel() { cancelled_ = true; }
  std::deque<Event> Take();

 private:
  void EndLocked();

  std::mutex mutex_;
  std::deque<Event> events_;
  std::string unit_;
  size_t done_ = 0, total_ = 0;
  std::atomic<bool> cancelled_ = false;
};

// Calls callback(kind, text, done, total) for every report and looks for signals until `finished` (given the time to
// wait, the GIL not held) says true. What Python raises in between cancels the work and is thrown when it has ended.
void Attend(Reports& reports, const py::object& callback,
            const std::function<bool(std::chrono::milliseconds)>& finished);

// The result of work(progress), done on a thread of its own, where parallel loops end on Ctrl-C without asking
// `progress`. `work` must not touch Python. Call with the GIL held.
template <class Work>
std::invoke_result_t<Work, Progress&> InBackground(const py::object& callback, const Work& work) {
  Reports reports;
  auto result = std::async(std::launch::async, [&] {
    const CancelScope scope(reports);
    return work(static_cast<Progress&>(reports));
  });
  Attend(reports, callback,
         [&](std::chrono::milliseconds time) { return result.wait_for(time) == std::future_status::ready; });
  return result.get();
}

}  // namespace glint::python
