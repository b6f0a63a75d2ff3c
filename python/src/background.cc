#include "background.h"

#include <optional>
#include <utility>

namespace glint::python {
namespace {

constexpr std::chrono::milliseconds kLookEvery(50);

void Deliver(Reports& reports, const py::object& callback) {
  if (PyErr_CheckSignals() != 0) throw py::error_already_set();
  for (const Reports::Event& e : reports.Take())
    if (!callback.is_none()) callback(e.kind, e.text, e.done, e.total);
}

}  // namespace

void Reports::Begin(std::string_view what, size_t total) {
  std::lock_guard lock(mutex_);
  EndLocked();
  unit_ = what;
  total_ = total;
  done_ = 0;
  if (!unit_.empty()) events_.push_back({"begin", unit_, 0, total_});
}

// Steps that nobody has fetched yet become one report.
void Reports::Advance(size_t steps) {
  std::lock_guard lock(mutex_);
  done_ += steps;
  if (events_.empty() || events_.back().kind != "advance") events_.push_back({"advance", unit_, 0, total_});
  events_.back().done = done_;
}

void Reports::Info(std::string_view message) {
  std::lock_guard lock(mutex_);
  events_.push_back({"info", std::string(message)});
}

void Reports::Warn(std::string_view message) {
  std::lock_guard lock(mutex_);
  events_.push_back({"warning", std::string(message)});
}

std::deque<Reports::Event> Reports::Take() {
  std::lock_guard lock(mutex_);
  return std::exchange(events_, {});
}

void Reports::EndLocked() {
  if (unit_.empty()) return;
  events_.push_back({"end", unit_, done_, total_});
  unit_.clear();
}

void Attend(Reports& reports, const py::object& callback,
            const std::function<bool(std::chrono::milliseconds)>& finished) {
  std::optional<py::error_already_set> raised;
  bool done = false;
  while (!done) {
    {
      const py::gil_scoped_release release;
      done = finished(kLookEvery);
    }
    if (raised) continue;
    try {
      Deliver(reports, callback);
    } catch (const py::error_already_set& e) {
      raised = e;
      reports.Cancel();
    }
  }
  if (raised) throw *raised;
}

}  // namespace glint::python
