// The object's outlines as the seed stage leaves them for the stages after it.
#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

#include "silhouette/outline.h"

namespace glint {

// One line a sample: view, px, ray, normal, depth, near, far, sigma. Reads back to exactly what was written. Reading
// throws InputError naming file and line when the file is missing or malformed, names a view that is not among the
// `num_views` of the scene, or has rays or normals that are not of unit length.
void WriteOutline(const std::filesystem::path& path, const std::vector<OutlineSample>& outline);
std::vector<OutlineSample> ReadOutline(const std::filesystem::path& path, size_t num_views);

}  // namespace glint
