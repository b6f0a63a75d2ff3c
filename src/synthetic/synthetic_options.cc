#include "synthetic/synthetic_options.h"

#include "synthetic/shapes.h"

namespace glint {

void SyntheticOptions::Visit(OptionVisitor& v) {
  v.Field({.name = "scene", .help = "Shape of the glossy object", .choices = ShapeNames()}, scene);
  v.Field({.name = "views", .help = "Number of photographs", .min = 3, .max = 2000}, views);
  v.Field({.name = "width", .help = "Image width", .unit = "px", .min = 32, .max = 16384}, width);
  v.Field({.name = "height", .help = "Image height", .unit = "px", .min = 32, .max = 16384}, height);
  v.Field({.name = "seed", .help = "Varies free-form shapes, cameras, lights, textures and noise", .min = 0}, seed);
  v.Field({.name = "fov_deg", .help = "Horizontal field of view", .unit = "deg", .min = 5, .max = 100}, fov_deg);
  v.Field({.name = "camera_model",
           .help = "COLMAP's camera model; other than PINHOLE with lens distortion",
           .choices = {"PINHOLE", "SIMPLE_RADIAL", "OPENCV"}},
          camera_model);
  v.Field({.name = "lights", .help = "Number of lights", .min = 1, .max = 3}, lights);
  v.Field({.name = "light_kind",
           .help = "distant and point stand still; flash is a point, camera a distant light that moves with the camera",
           .choices = {"distant", "point", "flash", "camera"}},
          light_kind);
  v.Field({.name = "light_angle_deg",
           .help = "Angular diameter of the lights: softens shadows, widens highlights",
           .unit = "deg",
           .min = 0,
           .max = 20},
          light_angle_deg);
  v.Field({.name = "roughness", .help = "GGX alpha of the gloss", .min = 0.005, .max = 1}, roughness);
  v.Field({.name = "reflectance",
           .help = "Fresnel reflectance at normal incidence; metal takes its base colour",
           .min = 0.005,
           .max = 1},
          reflectance);
  v.Field({.name = "base", .help = "Paint below the gloss", .choices = {"white", "black", "coloured", "metallic"}},
          base);
  v.Field({.name = "noise_levels",
           .help = "Standard deviation of the sensor noise",
           .unit = "levels of 255",
           .min = 0,
           .max = 50},
          noise_levels);
  v.Field({.name = "jpeg_quality", .help = "0: lossless PNG", .min = 0, .max = 100}, jpeg_quality);
  v.Field({.name = "object_points", .help = "Sparse points on the object", .min = 0, .max = 1e6}, object_points);
  v.Field({.name = "ground_points", .help = "Sparse points on its surroundings", .min = 0, .max = 1e6}, ground_points);
  v.Field({.name = "glossy_share",
           .help = "Share of the object's points that lie on its blank upper half",
           .min = 0,
           .max = 1},
          glossy_share);
  v.Field(
      {.name = "point_noise_px", .help = "Standard deviation of the observations", .unit = "px", .min = 0, .max = 20},
      point_noise_px);
  v.Field({.name = "virtual_share",
           .help = "Points triangulated on moving highlights, as a share of the object's points",
           .min = 0,
           .max = 1},
          virtual_share);
  v.Field({.name = "scale", .help = "Object radius in the model's world units", .min = 1e-9, .max = 1e9}, scale);
  v.Field({.name = "place", .help = "Turn and shift the world at random; else z is up, the object at the origin"},
          place);
  v.Field({.name = "write_masks", .help = "Also write the object masks beside the images, as an input"}, write_masks);
}

}  // namespace glint
