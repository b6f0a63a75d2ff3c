// From a seed mesh and highlights to the surface that agrees with them: specular bundle and level set in turn, coarse
// to fine, until the contacts stop moving (DESIGN 3.3, 3.4).
#pragma once

#include <string>
#include <vector>

#include "colmap/scene.h"
#include "constraints/contact.h"
#include "core/options.h"
#include "core/progress.h"
#include "geometry/triangle_mesh.h"
#include "highlights/highlight.h"
#include "io/image_source.h"
#include "io/normal_source.h"
#include "light/light.h"
#include "refine/bundle.h"
#include "refine/flow_step.h"
#include "refine/level_set_step.h"
#include "refine/photo_points.h"
#include "refine/photo_tilts.h"
#include "sdf/level_set.h"
#include "silhouette/outline.h"

namespace glint {

struct RefineOptions {
  double voxel_rel = 1.0 / 256;
  int levels = 3;
  double half_width_voxels = 3;
  int max_iterations = 4;
  double min_motion_voxels = 0.05;
  double min_point_sigma_rel = 0.0002;
  bool use_highlights = true;
  bool use_lobes = true;
  bool use_outlines = true;
  std::string method = "variational";  // or "flow"
  std::string bend = "auto";           // "seed", "flat", "auto": what the evidence is for
  std::string lights = "auto";         // "fixed", "solve", "auto": solve those with a standard deviation
  ContactOptions contacts;
  BundleOptions bundle;
  TiltOptions tilts;
  TextureOptions photo;
  LevelSetOptions level_set;
  FlowOptions flow;
  void Visit(OptionVisitor& v);
};

// All in world units. The seed must be closed and oriented outward.
struct RefineInput {
  const Scene& scene;
  const TriangleMesh& seed;
  std::vector<uint8_t> point_used;  // a scene point: lies on the object's surface; empty: none does
  std::vector<Highlight> highlights;
  std::vector<Light> lights;
  std::vector<OutlineSample> outline = {};
  const ImageSource* images = nullptr;    // for shading and texture; none: neither
  const NormalSource* normals = nullptr;  // none: no normal maps
};

struct IterationSummary {
  double voxel_rel = 0;
  int contacts_on_surface = 0;
  double contact_motion_voxels = 0;  // median, since the last iteration
  BundleSummary bundle;
  StepSummary step;
  double seconds = 0;
};

struct RefineSummary {
  std::vector<IterationSummary> iterations;
  bool bends_like_seed = false;
  int num_highlights = 0;
  int num_contacts = 0;
  int num_points = 0;
  int num_photo_points = 0;  // where texture shows the surface, the last time
  TiltSummary tilts;
  bool converged = false;
  std::vector<std::string> warnings;
};

struct RefineResult {
  LevelSet level_set;  // world units; empty (and said) where its voxels would be too small for OpenVDB
  TriangleMesh mesh;   // with normals, confidence, sigma_position_rel and sigma_normal_deg
  std::vector<Light> lights;
  std::vector<Highlight> highlights;
  std::vector<Contact> contacts;  // world units; accepted ones only
  RefineSummary summary;
};

// Throws InputError where the voxel size would need more memory than there is.
RefineResult Refine(const RefineInput& input, const RefineOptions& options, Progress& progress = Progress::Silent());

}  // namespace glint
