#include "refine/photo_points.h"

#include <cmath>

#include "photometry/surface_patches.h"
#include "stereo/textured_places.h"

namespace glint {

namespace {
constexpr double kSpacingRel = 0.01;  // of the patches
}

void TextureOptions::Visit(OptionVisitor& v) {
  v.Field({.name = "use", .help = "where the base has a texture, the surface is where the photographs agree on it"},
          use);
  v.Field({.name = "reach_rel",
           .help = "how far from the surface that is looked for",
           .unit = "fraction of the diagonal",
           .min = 1e-4,
           .max = 0.1},
          reach_rel);
  v.Field({.name = "share", .help = "of a place seen so that is independent of its neighbours", .min = 0, .max = 1},
          share);
  v.Field({.name = "max_views", .help = "photographs looked at, spread over all", .min = 4, .max = 10000}, max_views);
  v.Field({.name = "image_memory_mb",
           .help = "for small copies of the photographs",
           .unit = "MB",
           .min = 16,
           .max = 1 << 20},
          image_memory_mb);
}

PhotoPoints::PhotoPoints(const Scene& scene, const ImageSource* images, const TextureOptions& options,
                         const UnitFrame& frame, Progress& progress)
    : scene_(scene), options_(options), frame_(frame) {
  if (images && options.use && options.share > 0)
    colors_ = std::make_unique<SightColors>(*images, static_cast<size_t>(options.max_views),
                                            static_cast<size_t>(options.image_memory_mb) << 20, progress);
}

std::vector<PhotoPoint> PhotoPoints::Look(const TriangleMesh& surface, const std::vector<Light>& lights) const {
  if (!colors_) return {};
  std::vector<Light> lights_in_world;
  for (const Light& light : lights) lights_in_world.push_back(frame_.ToWorld(light));
  const std::vector<SurfacePatch> patches = SpreadPatches(frame_.ToWorld(surface), scene_, kSpacingRel / frame_.scale);
  std::vector<PhotoPoint> points;
  for (const TexturedPlace& place :
       FindTexturedPlaces(scene_, *colors_, patches, lights_in_world, options_.reach_rel / frame_.scale))
    points.push_back({frame_.FromWorld(place.position), frame_.scale * place.sigma / std::sqrt(options_.share)});
  return points;
}

}  // namespace glint
