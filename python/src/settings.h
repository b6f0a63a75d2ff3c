// Options from Python's dictionaries.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/error.h"
#include "pipeline/config.h"

namespace glint::python {

// As ResolveConfig(); messages speak of `config`, for that is what the caller gave.
inline Config ConfigFrom(const std::filesystem::path& file, const std::vector<std::string>& settings) {
  try {
    return ResolveConfig(file, settings);
  } catch (const InputError& e) {
    std::string message = e.what();
    const std::string theirs = "--set";
    for (size_t at; (at = message.find(theirs)) != std::string::npos;) message.replace(at, theirs.size(), "config");
    throw InputError("", "", message);
  }
}

}  // namespace glint::python
