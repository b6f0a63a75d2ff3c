// A complete synthetic scene in memory: what COLMAP would know of it, and the truth.
#pragma once

#include <memory>
#include <vector>

#include "colmap/model.h"
#include "core/progress.h"
#include "geometry/triangle_mesh.h"
#include "light/light.h"
#include "synthetic/render.h"
#include "synthetic/shapes.h"
#include "synthetic/sparse_points.h"
#include "synthetic/synthetic_options.h"

namespace glint {

// Everything but the stage is in the model's world frame and scale. Image v of the model is view v, its name
// "view_000.jpg" (or .png); its id is v + 1.
struct SyntheticScene {
  SyntheticOptions options;
  Model model;                                        // noisy tracks, true cameras
  std::vector<Light> lights;                          // truth
  std::shared_ptr<const ImplicitShape> shape;         // truth
  std::vector<SyntheticPoint::Origin> point_origins;  // of the model's points, in their order
  Similarity world_from_stage;
  std::shared_ptr<const Stage> stage;
};

// Throws InputError with every violated range of the options.
SyntheticScene SynthesizeScene(const SyntheticOptions& options, Progress& progress = Progress::Silent());

// One photograph, CV_8UC3 BGR, before its JPEG compression. Highlights are in the world.
void RenderView(const SyntheticScene& scene, size_t view, cv::Mat& image, ViewTruth& truth);

// The photograph as its file has it, and that file's bytes.
std::vector<unsigned char> EncodeImage(const SyntheticScene& scene, const cv::Mat& image);

// The surface as triangles with edges of about bounding diameter / `resolution`, all vertices on the surface, with
// normals.
TriangleMesh TrueMesh(const SyntheticScene& scene, int resolution = 220);

}  // namespace glint
