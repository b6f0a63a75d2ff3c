// How the time grows with the triangles and with the voxels.
#pragma once

#include <filesystem>

namespace glint::benchmark {

// Prints CPU seconds of Glint and OpenVDB for meshes of 10⁴ to 3·10⁶ triangles at 512³, and of 10⁴ triangles at 128³ to
// 1024³, and draws them with logarithmic axes.
void PlotGrowth(const std::filesystem::path& png);

}  // namespace glint::benchmark
