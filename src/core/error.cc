#include "core/error.h"

namespace glint {
namespace {

std::string Join(std::string_view path, std::string_view record, std::string_view what) {
  std::string message;
  for (std::string_view part : {path, record, what}) {
    if (part.empty()) continue;
    if (!message.empty()) message += ": ";
    message += part;
  }
  return message;
}

}  // namespace

InputError::InputError(std::string_view path, std::string_view record, std::string_view what)
    : Error(Join(path, record, what)), path_(path), record_(record) {}

}  // namespace glint
