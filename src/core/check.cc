#include "core/check.h"

namespace glint::internal {

void CheckFailed(const char* file, int line, const std::string& message) {
  throw std::logic_error(std::string(file) + ":" + std::to_string(line) + ": " + message);
}

}  // namespace glint::internal
