// Sparse points to a closed, oriented mesh of the object: what Glint starts on.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <string>
#include <vector>

#include "colmap/scene.h"
#include "core/options.h"
#include "core/progress.h"
#include "geometry/triangle_mesh.h"
#include "highlights/seed_surface.h"
#include "io/image_source.h"
#include "seed/fair.h"
#include "seed/object_choice.h"
#include "seed/reliable_points.h"
#include "seed/visibility_cut.h"
#include "silhouette/outline.h"
#include "silhouette/silhouettes.h"
#include "stereo/hollows.h"

namespace glint {

struct SeedOptions {
  ReliabilityOptions points;
  ObjectOptions object;
  CutOptions surface;
  SilhouetteOptions outlines;
  FairOptions smooth;
  bool open_hollows = true;

  void Visit(OptionVisitor& v);
};

// What became of a point of the scene.
enum class PointFate : uint8_t {
  kUsed,    // on the seed
  kObject,  // the object's, but the seed does not need it
  kGround,
  kContext,     // of something else
  kUnreliable,  // short track, large error, narrow angle, isolated
  kVirtual,
};

struct SeedResult {
  TriangleMesh mesh;                   // the sparse surface as it is: closed, oriented outward, one piece
  TriangleMesh smooth;                 // the same, faired through the points: what the level set starts on;
                                       // kFineScalar, kFootScalar
  std::vector<uint8_t> point_used;     // per scene point: 1 for a reliable point of the object's surface
  std::vector<PointFate> fate;         // per scene point
  std::vector<OutlineSample> outline;  // of the object, as far as the views confirm each other
  Eigen::AlignedBox3d region;          // around the object (world), with a margin of 5 % of its diagonal
};

struct SeedSummary {
  size_t num_points = 0;         // of the scene
  size_t num_unreliable = 0;     // short track, large error, narrow angle, isolated
  size_t num_virtual = 0;        // triangulated on highlights or reflections
  size_t num_object_points = 0;  // used for the surface
  bool ground_found = false;
  std::string object_chosen_by;    // "box", "masks", "ground and focus", "focus"
  long genus = 0;                  // of `smooth`
  double smooth_residual_rel = 0;  // median distance of the object's points from `smooth`, fraction of its diagonal
  SilhouetteSummary outlines;
  bool outlines_used = false;     // the seed follows them
  double outline_fit_before = 0;  // share of the outlines that the surface of the points alone agrees with
  double outline_fit = 0;         // and the one with the rim's points
  size_t num_rim_points = 0;
  long num_holes = 0;  // through the object, that only the photographs show
  HollowSummary hollows;
  bool hollows_opened = false;
  std::vector<std::string> warnings;

  std::string BriefReport() const;
};

// `images` (optional): masks that say which points are the object's; outlines from masks or photographs. With fewer
// than four points on the object, or none that enclose a volume, the meshes are empty and the summary's warnings say
// why. Scale, place and rotation of the world do not matter.
SeedResult BuildSeed(const Scene& scene, const SeedOptions& options = {}, SeedSummary* summary = nullptr,
                     Progress& progress = Progress::Silent(), const ImageSource* images = nullptr);

}  // namespace glint
