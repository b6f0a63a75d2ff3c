// The colours of a surface from the photographs, without its highlights.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "colmap/scene.h"
#include "core/progress.h"
#include "geometry/triangle_mesh.h"
#include "highlights/highlight.h"
#include "io/image_source.h"

namespace glint {

struct SurfaceColorOptions {
  int max_views = 15;             // that see a vertex most squarely
  double max_incidence_deg = 75;  // a view that sees it flatter says little of its colour
  double margin_px = 3;           // around a highlight
};

struct SurfaceColors {
  std::vector<std::array<uint8_t, 3>> rgb;  // per vertex, sRGB as in the photographs
  size_t num_seen = 0;                      // vertices with a colour of their own; the others take their neighbours'
};

// The median, channel by channel, over the views that see a vertex with no highlight there; highlights that the gate
// rejected as paint are colour. Where a highlight is in all of them, the darkest. The mesh has normals. Memory goes
// with the number of vertices; each image is read once.
SurfaceColors ColorSurface(const TriangleMesh& mesh, const Scene& scene, const ImageSource& images,
                           const std::vector<Highlight>& highlights, const SurfaceColorOptions& options,
                           Progress& progress);

}  // namespace glint
