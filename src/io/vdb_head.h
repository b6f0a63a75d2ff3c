// The head of an OpenVDB file, checked before OpenVDB reads it. Internal to io/.
#pragma once

#include <filesystem>

namespace glint::internal {

// OpenVDB allocates what a file's lengths and counts say, and reads past the end of a cut file without noticing. Throws
// InputError unless the file's metadata, its directory of grids and each grid's metadata lie within the file as they
// say.
void CheckVdbHead(const std::filesystem::path& path);

}  // namespace glint::internal
