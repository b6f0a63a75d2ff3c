// The libraries that results depend on, and their versions.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace glint {

// (name, version), by name; the last one is the compiler.
std::vector<std::pair<std::string, std::string>> LibraryVersions();

}  // namespace glint
