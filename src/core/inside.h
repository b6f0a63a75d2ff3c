// Where paths lead once links are followed.
#pragma once

#include <filesystem>

namespace glint {

// True if `path` lies in `folder` or is the folder, every link on both ways followed. What does not exist yet is taken
// as it is written.
bool LiesInside(const std::filesystem::path& path, const std::filesystem::path& folder);

}  // namespace glint
