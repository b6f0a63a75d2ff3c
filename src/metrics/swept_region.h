// The part of the true surface that highlights pass over: what Glint is measured on.
#pragma once

#include <cstdint>
#include <vector>

#include "colmap/scene.h"
#include "geometry/triangle_mesh.h"
#include "light/light.h"

namespace glint {

// Per vertex of `truth` (with vertex normals; scene's frame): non-zero if, for at least one view and one light, the
// vertex projects into the image, nothing lies between it and the camera, nothing between it and the light, it faces
// both, and its normal is within `max_angle_deg` of the half vector. `occluders`: further surfaces that may hide the
// vertex or shadow it; nullptr: the truth alone.
std::vector<uint8_t> SweptRegion(const TriangleMesh& truth, const Scene& scene, const std::vector<Light>& lights,
                                 double max_angle_deg = 3, const TriangleMesh* occluders = nullptr);

// Per vertex of `truth`: in how many views it is visible (projects into the image, faces the camera, not hidden).
std::vector<uint16_t> VisibleViews(const TriangleMesh& truth, const Scene& scene,
                                   const TriangleMesh* occluders = nullptr);

}  // namespace glint
