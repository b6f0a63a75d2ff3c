// report.html: a run explained in a browser. One file that needs nothing else: viewer, photographs, numbers, advice.
#pragma once

#include <string>

#include "colmap/scene.h"
#include "core/progress.h"
#include "geometry/triangle_mesh.h"
#include "io/image_source.h"
#include "pipeline/config.h"
#include "pipeline/run.h"
#include "refine/refine.h"

namespace glint {

// What the page is made from. A run that gives up early has no meshes, contacts or highlights: they are empty then.
struct PageInput {
  const RunSummary& summary;
  const Config& config;
  const Scene& scene;
  const ImageSource& images;
  const TriangleMesh& seed;  // with vertex normals or without
  const RefineResult& refined;
};

struct PageOptions {
  size_t max_faces = 300000;  // of each mesh; larger ones are simplified for the page, and the page says so
  int max_photos = 60;        // spread evenly over the views
  int photo_side_px = 720;
};

// The whole file. Deterministic but for the text of its element "glint-run": command and times. Names and texts from
// files reach the page as JSON in which every character that HTML could take for markup is escaped.
std::string ReportPage(const PageInput& input, Progress& progress = Progress::Silent(),
                       const PageOptions& options = {});

}  // namespace glint
