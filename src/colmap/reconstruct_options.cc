#include <fmt/format.h>

#include "colmap/reconstruct.h"

namespace glint {

void ReconstructOptions::Visit(OptionVisitor& v) {
  v.Field({.name = "program", .help = "COLMAP's program: found on the PATH, or its file."}, program);
  v.Field(
      {.name = "matcher",
       .help = "Which images are matched: all with all, along the order of their names (loops are closed), or those "
               "that a vocabulary tree finds alike; auto goes by their number and order.",
       .choices = {"auto", "exhaustive", "sequence", "vocabulary"}},
      matcher);
  v.Field({.name = "vocabulary_tree", .help = "COLMAP's file of a vocabulary tree, for many images in no order."},
          vocabulary_tree);
  v.Field({.name = "max_pairs",
           .help = "Up to so many pairs of images all are matched with all (on a GPU 20 times as many).",
           .min = 1,
           .max = 1e7},
          max_pairs);
  v.Field({.name = "cameras",
           .help = "One camera for all images, one for each, or, auto, one if all images have the same size.",
           .choices = {"auto", "one", "each"}},
          cameras);
  v.Field({.name = "camera_model",
           .help = "COLMAP's camera model.",
           .choices = {"SIMPLE_PINHOLE", "PINHOLE", "SIMPLE_RADIAL", "RADIAL", "OPENCV", "OPENCV_FISHEYE",
                       "FULL_OPENCV", "FOV", "SIMPLE_RADIAL_FISHEYE", "RADIAL_FISHEYE", "THIN_PRISM_FISHEYE"}},
          camera_model);
  v.Field({.name = "max_side_px",
           .help = "Features are looked for in images scaled down to this.",
           .unit = "px",
           .min = 100,
           .max = 65535},
          max_side_px);
  v.Field({.name = "use_gpu", .help = "If that COLMAP was built with CUDA."}, use_gpu);
  v.Field(
      {.name = "stall_limit_min",
       .help = "COLMAP hangs, and is ended, when it neither prints nor uses processor time for so long; 0: no limit.",
       .unit = "minutes",
       .min = 0},
      stall_limit_min);
  v.Field({.name = "time_limit_min",
           .help = "Longest time for one call of COLMAP; 0: no limit.",
           .unit = "minutes",
           .min = 0},
          time_limit_min);
}

std::string ReconstructSummary::BriefReport() const {
  std::string text = fmt::format("COLMAP {}{}: {} of {} images registered ({} matching", version,
                                 gpu ? " on the GPU" : "", num_registered(), num_images, matcher);
  for (const ReconstructStep& step : steps)
    text += step.reused ? fmt::format("; {} of an earlier run", step.name)
                        : fmt::format("; {} {:.0f} s", step.name, step.seconds);
  return text + ")";
}

std::vector<std::string> ReconstructSummary::Advice() const {
  constexpr size_t kFewFeatures = 800;
  std::vector<std::string> advice;
  if (median_features > 0 && median_features < kFewFeatures)
    advice.push_back(
        fmt::format("a typical image has only {} features: take sharp photographs, and put something with much detail "
                    "(printed paper, a patterned cloth) under and around the object, where it is seen in every image",
                    median_features));
  if (model_sizes.size() > 1)
    advice.push_back(
        fmt::format("the images fall into {} groups that do not connect: add photographs from places between, so that "
                    "neighbours overlap by two thirds",
                    model_sizes.size()));
  if (matcher != "exhaustive")
    advice.push_back("not all images were matched with all: try --set photos.colmap.matcher=exhaustive");
  advice.push_back(
      "walk around the object with steps of at most 10 to 15 degrees; turning the camera in one place does not help");
  advice.push_back(
      "if the object stood on a turntable before a fixed camera, the background contradicts it: give masks of the "
      "object (<image name>.png, 0 elsewhere) with --set photos.feature_masks=FOLDER");
  return advice;
}

}  // namespace glint
