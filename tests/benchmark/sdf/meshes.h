// The meshes of the benchmark: files, and generated ones.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "geometry/triangle_mesh.h"

namespace glint::benchmark {

// "smooth:N", "scan:N" (uneven triangles with noise, as scanners leave them) and "spiky:N" (very sharp and very obtuse
// vertices) are closed spheres of about N triangles; anything else is a file.
TriangleMesh MakeMesh(const std::string& name, const std::filesystem::path& folder);

}  // namespace glint::benchmark
