// Level sets as OpenVDB files.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sdf/level_set.h"

namespace glint {

// The grid's name in files that Glint writes: what Houdini and Blender call a signed distance field.
inline constexpr const char* kVdbGridName = "surface";

// Writes one float grid: class level set, named "surface", world units, with its statistics as metadata. Atomic; the
// same level set gives the same bytes. Throws InputError if the file cannot be written whole.
void WriteVdb(const std::filesystem::path& path, const LevelSet& level_set);

// Reads the grid "surface", else the only level set of the file. Throws InputError naming the file and the grid: no
// OpenVDB file, one that is cut, no level set (for example a fog volume), voxels that are not cubes, values that are
// not finite. `notes`, if given, gets what was chosen among several grids.
LevelSet ReadVdb(const std::filesystem::path& path, std::vector<std::string>* notes = nullptr);

}  // namespace glint
