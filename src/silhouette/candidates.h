// One view's mask, given or found, and its outline. Only for .cc files of this module: it brings OpenCV along.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "colmap/scene.h"
#include "io/image_source.h"
#include "silhouette/agreement.h"
#include "silhouette/silhouettes.h"
#include "silhouette/view_mask.h"

namespace glint::internal {

// A view with all that is worked out for it.
struct Candidate {
  ViewMask mask;
  std::vector<ContourPoint> contour;  // with an edge, where it was found
  double sigma_px = 0;                // raster px
  double overlap = 0;                 // with the rough mesh's projection
  bool found = false;                 // in the photograph
};

struct Work {
  const Scene& scene;
  const ImageSource& images;
  const RoughObject& rough;
  double diagonal;
  Eigen::Vector3d center;

  // Around the object, with room to spare.
  Reach Ball() const { return {center, 0.75 * diagonal}; }
  double RasterFocal(size_t view, const internal::Raster& raster) const {
    return MeanFocalLength(scene.views[view].camera) * raster.scale;
  }
  double DiagonalPx(size_t view, const internal::Raster& raster) const {
    return diagonal * RasterFocal(view, raster) / (scene.views[view].Center() - center).norm();
  }
};

// Nothing where there is no mask, or the rough mesh is not in the image.
std::optional<Candidate> FromMask(const Work& work, size_t view);

// Nothing where there is no photograph, or the rough mesh is not in it. `hull`: what other views leave room for; null:
// not known.
std::optional<Candidate> FromPhotograph(const Work& work, size_t view, const TriangleMesh* hull);

}  // namespace glint::internal
