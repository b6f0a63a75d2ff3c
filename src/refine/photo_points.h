// What matte texture in the photographs says of the surface's place, wherever the surface is at the time.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "colmap/scene.h"
#include "core/options.h"
#include "core/progress.h"
#include "geometry/triangle_mesh.h"
#include "highlights/sight_colors.h"
#include "io/image_source.h"
#include "light/light.h"
#include "refine/normalized.h"

namespace glint {

struct TextureOptions {
  bool use = true;
  double reach_rel = 0.01;
  double share = 0.25;
  int max_views = 64;
  int image_memory_mb = 512;
  void Visit(OptionVisitor& v);
};

// In units of the object's diagonal.
struct PhotoPoint {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  double sigma = 0;  // across the surface; neighbours err alike, it is larger for that
};

class PhotoPoints {
 public:
  // `images`: none, nothing is seen. Reads them once; keeps references to the rest.
  PhotoPoints(const Scene& scene, const ImageSource* images, const TextureOptions& options, const UnitFrame& frame,
              Progress& progress);

  // `surface` and `lights` in units of the object's diagonal, the surface with normals.
  std::vector<PhotoPoint> Look(const TriangleMesh& surface, const std::vector<Light>& lights) const;

 private:
  const Scene& scene_;
  const TextureOptions& options_;
  const UnitFrame frame_;
  std::unique_ptr<SightColors> colors_;
};

}  // namespace glint
