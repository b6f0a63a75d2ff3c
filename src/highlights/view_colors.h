// Small linear colour images of all views.
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
class ViewColors {
 public:
  // Streams the images once; views without an image stay empty.
  ViewColors(const ImageSource& images, size_t memory_bytes, Progress& progress);
  ~ViewColors();

  bool Has(size_t view) const;

  // Linear red, green and blue (1 = sensor white), the mean within so many image pixels of one in COLMAP's frame;
  // nullopt off the image, where the mask ignores it, and where a channel is cut off at white.
  std::optional<Eigen::Array3d> Mean(size_t view, const Eigen::Vector2d& px, double radius_px) const;

 private:
  std::unique_ptr<ViewMaps> maps_;
};

}  // namespace glint
