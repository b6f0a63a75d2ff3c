// A mesh made fit for signed distance: checked, welded, and without faces that cannot carry a normal.
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/triangle_mesh.h"

namespace glint {

struct CleanMesh {
  TriangleMesh mesh;                  // positions and faces only; every vertex is used
  std::vector<uint32_t> source_face;  // of each face: the face of the input that it comes from
  size_t welded_vertices = 0;         // vertices at exactly the position of another one
  size_t collapsed_faces = 0;         // faces left out because two of their corners are one vertex
};

// Throws InputError if the mesh has no faces, a vertex that is used is not finite, or an index is out of range.
// Exactly equal positions become one vertex (-0 equals 0).
CleanMesh Clean(const TriangleMesh& mesh);

// Only the checks of Clean().
void CheckMesh(const TriangleMesh& mesh);

}  // namespace glint
