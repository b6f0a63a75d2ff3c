// Everything that is rendered, in the object's own frame: z up, the object about one unit in radius at the origin.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <vector>

#include "colmap/camera.h"
#include "geometry/rigid.h"
#include "light/light.h"
#include "synthetic/marks.h"
#include "synthetic/shape_tracer.h"
#include "synthetic/shapes.h"
#include "synthetic/surroundings.h"
#include "synthetic/synthetic_options.h"

namespace glint {

struct Gloss {
  Eigen::Array3d albedo;                                  // of the paint, linear
  Eigen::Array3d reflectance;                             // Fresnel at normal incidence
  double alpha;                                           // GGX
  Eigen::Array3d transmittance = Eigen::Array3d::Zero();  // of a pane
};

// `irradiance`: what the light adds to the radiance of a white diffuse surface that faces it; of a point light at the
// distance `reference_distance`.
struct StageLight {
  Light light;
  double irradiance;
  double reference_distance;

  // From a surface point to the light; very large for a distant one.
  double Distance(const Rigid3d& cam_from_stage, const Eigen::Vector3d& x) const;
};

struct StageView {
  Camera camera;
  Rigid3d cam_from_stage;

  Eigen::Vector3d Center() const;
  std::optional<Eigen::Vector3d> RayThrough(const Eigen::Vector2d& px) const;
  std::optional<Eigen::Vector2d> Project(const Eigen::Vector3d& x) const;
  bool Contains(const Eigen::Vector2d& px) const;
};

enum class SurfaceKind : uint8_t { kSky, kGround, kInterior, kObject };

struct SurfaceHit {
  SurfaceKind kind = SurfaceKind::kSky;
  double t = 0;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
};

struct Stage {
  uint64_t seed = 0;
  std::shared_ptr<const ImplicitShape> shape;
  std::shared_ptr<const ShapeTracer> tracer;  // of the shape
  Gloss gloss;
  Marks marks;
  Surroundings surroundings;
  std::vector<StageLight> lights;
  double light_radius = 0;  // angular, radians
  double exposure = 1;      // sensor values for a radiance; 1 is sensor white
  std::vector<StageView> views;

  // What a ray meets first; beyond the object itself where `past_object`.
  SurfaceHit Trace(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, bool past_object = false) const;

  // Where the view sees the surface point; nullopt where something hides it, or it is outside the image.
  std::optional<Eigen::Vector2d> SeenAt(const StageView& view, const SurfaceHit& point) const;

  // Share of light that passes from the surface point towards `direction` for `distance` units.
  double Visibility(const SurfaceHit& from, const Eigen::Vector3d& direction, double distance) const;

  // Fresnel reflectance at normal incidence: marks on metal are paint, not metal.
  Eigen::Array3d ReflectanceAt(const Eigen::Vector3d& x) const;

  // False where one looks through the object: on a pane, inside its opaque border and away from its marks.
  bool OpaqueAt(const Eigen::Vector3d& x) const;
  bool transparent() const { return gloss.transmittance.maxCoeff() > 0; }
};

Stage MakeStage(const SyntheticOptions& options);

}  // namespace glint
