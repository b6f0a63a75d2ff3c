// Pictures of meshes.
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/picture_view.h"
#include "geometry/triangle_mesh.h"

namespace glint {

struct MeshLook : Look {
  bool smooth = true;      // interpolate vertex normals where the mesh has them
  bool hidden_sky = true;  // darken hollows
  bool edges = false;      // draw the edges of the triangles
};

// sRGB, three bytes a pixel, rows from the top. Vertex colours are used where the mesh has them. Deterministic.
std::vector<uint8_t> RenderMesh(const TriangleMesh& mesh, const PictureView& view, const MeshLook& look = {});

}  // namespace glint
