// The pictures of the documentation.
#pragma once

#include <filesystem>

namespace glint::benchmark {

// offset_surfaces.png: one mesh at four levels, by rays through its field. angle_weights.png: slices through sharp tips
// with the signs of four weightings of the vertex normals, wrong ones in red.
void WritePictures(const std::filesystem::path& folder);

}  // namespace glint::benchmark
