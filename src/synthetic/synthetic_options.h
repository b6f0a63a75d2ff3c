// What a synthetic scene is made of.
#pragma once

#include <string>

#include "core/options.h"

namespace glint {

struct SyntheticOptions {
  std::string scene = "sphere";
  int views = 48;
  int width = 800;
  int height = 600;
  int seed = 1;

  double fov_deg = 45;
  std::string camera_model = "PINHOLE";

  int lights = 1;
  std::string light_kind = "distant";
  double light_angle_deg = 0;

  double roughness = 0.05;
  double reflectance = 0.04;
  std::string base = "coloured";

  double noise_levels = 1;
  int jpeg_quality = 95;

  int object_points = 320;
  int ground_points = 160;
  double glossy_share = 0.136;
  double point_noise_px = 0.5;
  double virtual_share = 0.03;

  double scale = 1;
  bool place = true;
  bool write_masks = false;

  void Visit(OptionVisitor& v);
};

}  // namespace glint
