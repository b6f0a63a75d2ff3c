// The highlights of an earlier run back to COLMAP, which then takes no features on them.
#pragma once

#include <filesystem>

namespace glint {

// Where the masks of an earlier run in `out` are kept for COLMAP: copies them to a folder beside them, all or none.
// What lies there already stays unless they are to be taken `anew`: each run leaves somewhat other masks, and the same
// command again is to find what it made. Throws InputError if there are none, `project` is a COLMAP project, on which
// COLMAP is not run, or another run holds `out`.
std::filesystem::path KeepMasksForFeatures(const std::filesystem::path& project, const std::filesystem::path& out,
                                           bool anew);

}  // namespace glint
