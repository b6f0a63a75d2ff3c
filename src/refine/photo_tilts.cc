#include "refine/photo_tilts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/square.h"

namespace glint {

namespace {
constexpr double kSpacingRel = 0.01;  // of the patches
}

void TiltOptions::Visit(OptionVisitor& v) {
  v.Field({.name = "use_shading", .help = "the shading of the matte base under known lights, too"}, use_shading);
  v.Field({.name = "shading_weight", .help = "of the normals from shading", .min = 0, .max = 1e4}, shading_weight);
  v.Field({.name = "normal_map_weight", .help = "of the normals from maps (--normals)", .min = 0, .max = 1e4},
          normal_map_weight);
  v.Field({.name = "length_rel",
           .help = "distance over which the errors of shading, and of normal maps, are alike",
           .unit = "fraction of the diagonal",
           .min = 1e-3,
           .max = 1},
          length_rel);
  v.Field({.name = "image_memory_mb",
           .help = "for small copies of the photographs",
           .unit = "MB",
           .min = 16,
           .max = 1 << 20},
          image_memory_mb);
}

std::string TiltSummary::BriefReport() const {
  std::string said;
  const auto used = std::count_if(materials.begin(), materials.end(), [](const Material& m) { return m.used; });
  if (!materials.empty())
    said = fmt::format("shading says something of the normals of {} patches; it follows them in {} of {} materials",
                       num_shaded, used, materials.size());
  if (num_given_normals > 0)
    said += fmt::format("{}normal maps show {} patches, single maps scatter by {:.1f} deg", said.empty() ? "" : "; ",
                        num_given_normals, normal_map_scatter_deg);
  return said;
}

PhotoTilts::PhotoTilts(const Scene& scene, const ImageSource* images, const NormalSource* normals,
                       const TiltOptions& options, const UnitFrame& frame, Progress& progress)
    : scene_(scene), normals_(normals), options_(options), frame_(frame) {
  if (images && options.use_shading)
    colors_ = std::make_unique<ViewColors>(*images, static_cast<size_t>(options.image_memory_mb) << 20, progress);
}

void PhotoTilts::LookAgain(const TriangleMesh& surface, const std::vector<Light>& lights, bool reliable_normals) {
  tilts_.clear();
  const bool shading = colors_ && reliable_normals && !lights.empty();
  if (!shading && !normals_) return;
  const TriangleMesh world = frame_.ToWorld(surface);
  std::vector<SurfacePatch> patches = SpreadPatches(world, scene_, kSpacingRel / frame_.scale);
  if (normals_) {
    const GivenNormals given = TiltsFromNormalMaps(*normals_, scene_, patches);
    summary_.num_given_normals = static_cast<int>(given.num_patches);
    summary_.normal_map_scatter_deg = given.scatter_deg;
    Take(given.tilts, options_.normal_map_weight);
  }
  if (!shading) return;
  std::vector<Light> lights_in_world;
  for (const Light& light : lights) lights_in_world.push_back(frame_.ToWorld(light));
  TakeLooks(scene_, *colors_, lights_in_world, patches);
  const ShadingTilts seen = TiltsFromShading(world, scene_, lights_in_world, patches);
  summary_.materials = seen.materials;
  summary_.num_shaded = static_cast<int>(seen.tilts.size());
  Take(seen.tilts, options_.shading_weight);
}

void PhotoTilts::Take(const std::vector<Tilt>& tilts, double weight) {
  if (weight == 0) return;
  for (Tilt tilt : tilts) {
    tilt.position = frame_.FromWorld(tilt.position);
    tilt.radius_world *= frame_.scale;
    tilt.share = weight * std::min(1.0, Square(kSpacingRel / options_.length_rel));
    tilts_.push_back(tilt);
  }
}

}  // namespace glint
