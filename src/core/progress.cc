#include "core/progress.h"

#include "core/error.h"

namespace glint {

void Progress::Begin(std::string_view, size_t) {}
void Progress::Advance(size_t) {}
void Progress::Info(std::string_view) {}
void Progress::Warn(std::string_view) {}
bool Progress::Cancelled() const { return false; }

void Progress::ThrowIfCancelled() const {
  if (Cancelled()) throw CancelledError();
}

Progress& Progress::Silent() {
  static Progress silent;
  return silent;
}

}  // namespace glint
