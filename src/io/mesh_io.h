// Reading and writing triangle meshes and point clouds.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "geometry/triangle_mesh.h"

namespace glint {

// Reads PLY (ASCII, binary of both endians), OBJ, OFF, STL (ASCII, binary); the format is told by the content, then
// by the extension. Polygons are triangulated. Normals and colours of the vertices, `confidence` and further scalar
// properties of a PLY are kept; STL's equal vertices are merged. Faces keep the file's orientation, also where they
// are degenerate. Throws InputError naming file and record: a cut file, a count that the file cannot hold, a
// coordinate that is not finite, an index out of range, no face at all.
TriangleMesh ReadMesh(const std::filesystem::path& path);

// `normals` and `colors` are empty or have one entry a point.
struct PointCloud {
  std::vector<Eigen::Vector3d> positions;
  std::vector<Eigen::Vector3d> normals;  // unit
  std::vector<std::array<uint8_t, 3>> colors;
};

// The vertices of any of these files, such as COLMAP's fused.ply; faces are not needed and left out.
PointCloud ReadPointCloud(const std::filesystem::path& path);

// Writes by extension: .ply (binary; normals, colours, `confidence` and the named scalars), .obj (normals, colours)
// or .glb (glTF 2.0 binary: normals, colours, `_CONFIDENCE` and the scalars as `_NAME`). Atomic; the same mesh gives
// the same bytes. Coordinates are written as 32-bit floats where that rounds by less than 1e-6 of the diagonal, else
// as doubles (PLY, OBJ) or relative to the node's translation (GLB). Throws InputError for another extension or if
// the file cannot be written.
void WriteMesh(const std::filesystem::path& path, const TriangleMesh& mesh);

}  // namespace glint
