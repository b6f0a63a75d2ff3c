// What photographs and normal maps say of the surface's normals beside highlights, wherever the surface is at the time.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "colmap/scene.h"
#include "core/options.h"
#include "core/progress.h"
#include "geometry/triangle_mesh.h"
#include "highlights/view_colors.h"
#include "io/image_source.h"
#include "io/normal_source.h"
#include "light/light.h"
#include "photometry/normal_maps.h"
#include "photometry/shading.h"
#include "refine/normalized.h"

namespace glint {

struct TiltOptions {
  bool use_shading = true;
  double shading_weight = 1;
  double normal_map_weight = 1;
  double length_rel = 0.05;
  int image_memory_mb = 512;
  void Visit(OptionVisitor& v);
};

struct TiltSummary {
  std::vector<Material> materials;    // whose shading was used, or not, the last time
  int num_shaded = 0;                 // patches whose shading says something of their normal
  int num_given_normals = 0;          // patches that normal maps show
  double normal_map_scatter_deg = 0;  // what single maps are off by

  std::string BriefReport() const;  // a sentence; empty if there was neither
};

class PhotoTilts {
 public:
  // `images`, `normals`: none, no shading or no normal maps. Reads the images once; keeps references to the rest.
  PhotoTilts(const Scene& scene, const ImageSource* images, const NormalSource* normals, const TiltOptions& options,
             const UnitFrame& frame, Progress& progress);

  // `surface` and `lights` in units of the object's diagonal, the surface with normals. `reliable_normals`: a seed's
  // are no measure for brightness.
  void LookAgain(const TriangleMesh& surface, const std::vector<Light>& lights, bool reliable_normals);

  // In units of the object's diagonal.
  const std::vector<Tilt>& tilts() const { return tilts_; }
  const TiltSummary& summary() const { return summary_; }

 private:
  void Take(const std::vector<Tilt>& tilts, double weight);

  const Scene& scene_;
  const NormalSource* normals_;
  const TiltOptions& options_;
  const UnitFrame frame_;
  std::unique_ptr<ViewColors> colors_;
  std::vector<Tilt> tilts_;
  TiltSummary summary_;
};

}  // namespace glint
