// What the views show at a place, and how alike it is.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "core/progress.h"
#include "io/image_source.h"

namespace glint {

class ViewMaps;

// Immutable, thread-safe.
class SightColors {
 public:
  // Streams the images once, those of at most `most_views` views spread over all of them, and blurs them by about a
  // pixel; the other views show nothing.
  SightColors(const ImageSource& images, size_t most_views, size_t memory_bytes, Progress& progress);
  ~SightColors();

  bool Has(size_t view) const;
  // Pixels of the image that one of its copy is wide; the view has one.
  double PixelSize(size_t view) const;

  // Red, green and blue as the eye counts them (the square root of linear light, 1 = sensor white); nullopt off the
  // image, where the mask ignores it and where it is cut off at white.
  std::optional<Eigen::Array3f> At(size_t view, const Eigen::Vector2d& px) const;

 private:
  std::unique_ptr<ViewMaps> maps_;
};

// Median over the colours of their distance from the channels' medians; +inf for fewer than `fewest`. Reorders them.
float ColorSpread(std::vector<Eigen::Array3f>& colors, size_t fewest);

}  // namespace glint
