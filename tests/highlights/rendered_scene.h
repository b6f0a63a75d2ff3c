// A small rendered scene with its true surface as the seed.
#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "highlights/detect.h"
#include "synthetic/synthetic_image_source.h"

namespace glint::testing {

inline SyntheticOptions SmallScene(const std::string& kind, int lights) {
  SyntheticOptions options;
  options.scene = "ellipsoid";
  options.views = 16;
  options.width = 320;
  options.height = 240;
  options.light_kind = kind;
  options.lights = lights;
  return options;
}

// The same scene in the light of only one of its lamps.
inline SyntheticScene LitByOne(SyntheticScene scene, size_t light) {
  auto stage = std::make_shared<Stage>(*scene.stage);
  stage->lights = {stage->lights[light]};
  scene.stage = stage;
  scene.lights = {scene.lights[light]};
  return scene;
}

inline std::vector<cv::Mat> Photographs(const SyntheticImageSource& source) {
  std::vector<cv::Mat> images(source.size());
  for (size_t v = 0; v < source.size(); ++v) source.Load(v, images[v]);
  return images;
}

inline std::vector<Highlight> Candidates(const std::vector<cv::Mat>& images) {
  std::vector<Highlight> candidates;
  for (size_t v = 0; v < images.size(); ++v)
    for (const Highlight& h : DetectHighlights(images[v], cv::Mat(), static_cast<uint32_t>(v), {}))
      candidates.push_back(h);
  return candidates;
}

}  // namespace glint::testing
