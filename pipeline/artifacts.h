// What one stage leaves for the next in the workspace, so that a run can go on from any stage. Everything reads back
// to exactly what was written.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <vector>

#include "highlights/highlight.h"

namespace glint {

// Highlights as JSON, the status by its name. Reading throws InputError naming file and record when the file is
// missing or malformed or names a view or a light that is not among the `num_views` of the scene and the `num_lights`.
void WriteHighlights(const std::filesystem::path& path, const std::vector<Highlight>& highlights);
std::vector<Highlight> ReadHighlights(const std::filesystem::path& path, size_t num_views,
                                      size_t num_lights = std::numeric_limits<int>::max());

// One flag (0 or 1) an entry, as a text of digits. Reading throws InputError unless there are `count`.
void WriteFlags(const std::filesystem::path& path, const std::vector<uint8_t>& flags);
std::vector<uint8_t> ReadFlags(const std::filesystem::path& path, size_t count);

}  // namespace glint
