// The single mesh formats. Internal to io/; see mesh_io.h.
#pragma once

#include <cstdint>
#include <filesystem>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/triangle_mesh.h"

namespace glint::internal {

// Each parses the file's whole content. `path` is for messages alone.
TriangleMesh ParsePly(std::string_view bytes, const std::filesystem::path& path);
TriangleMesh ParseObj(std::string_view bytes, const std::filesystem::path& path);
TriangleMesh ParseOff(std::string_view bytes, const std::filesystem::path& path);
TriangleMesh ParseStl(std::string_view bytes, const std::filesystem::path& path);

void WritePly(const TriangleMesh& mesh, std::ostream& out);
void WriteObj(const TriangleMesh& mesh, std::ostream& out);
void WriteGlb(const TriangleMesh& mesh, std::ostream& out);

// True if 32-bit floats hold the coordinates to 1e-6 of the diagonal.
bool FloatsSuffice(const TriangleMesh& mesh);

// Appends the triangles of one polygon, oriented as it is. Convex or not, nearly planar; a polygon that cannot be
// triangulated well (self-intersecting, without area) becomes a fan. `indices` has at least 3 entries.
void AppendPolygon(const std::vector<Eigen::Vector3d>& vertices, const std::vector<int>& indices,
                   std::vector<Eigen::Vector3i>& faces);

// As above for a file's face: throws InputError naming "KIND NUMBER" if an index is out of range. Fewer than 3 vertices
// are a point or a line and are left out.
void AppendCheckedPolygon(TriangleMesh& mesh, const std::vector<int>& indices, const std::filesystem::path& path,
                          std::string_view kind, uint64_t number);

}  // namespace glint::internal
