#include "highlights/find_lights.h"

#include <algorithm>
#include <cmath>

#include "core/check.h"
#include "geometry/convex_distance.h"
#include "highlights/expected_views.h"
#include "highlights/exposure.h"
#include "highlights/judge_lights.h"
#include "highlights/lamp_size.h"
#include "highlights/light_groups.h"
#include "highlights/moving_candidates.h"
#include "highlights/seed_surface.h"
#include "highlights/view_brightness.h"
#include "light/light_covariance.h"

namespace glint {
namespace {

constexpr int kPasses = 2;
constexpr double kLampRoomRel = 0.05;  // of the diagonal: no lamp is nearer to the object

std::vector<LightObservation> Observe(const Scene& scene, const SeedSurface& surface,
                                      const std::vector<Highlight>& candidates, const std::vector<Moving>& moving) {
  std::vector<LightObservation> observations;
  for (const Moving& m : moving) {
    const Highlight& h = candidates[m.candidate];
    const View& view = scene.views[h.view];
    // The seed's normal where the ray meets it: its neighbours' would fit almost any light.
    const SurfaceSample at = surface.Neighbourhood(view.Center(), *view.RayThrough(h.px)).front();
    observations.push_back({view.cam_from_world, at.position, at.normal, m.may_move});
  }
  return observations;
}

LightFitOptions FitOptions(const GateOptions& gate, const FindLightsOptions& options, const TriangleMesh& seed) {
  LightFitOptions fit;
  fit.max_lights = options.max_lights;
  fit.min_support = options.min_support;
  fit.max_incidence_deg = gate.max_incidence_deg + 5;
  fit.max_normal_sigma_deg = options.max_normal_sigma_deg;
  fit.allow_distant = options.kinds != "point";
  fit.allow_point = options.kinds != "distant";
  // A lamp in the object or in a bowl's mouth would be in the photographs, though all of a flash's reflections in a
  // bowl point there.
  fit.may_be_at = [&seed, room = kLampRoomRel * Diagonal(seed)](const Eigen::Vector3d& lamp) {
    return !NearConvexHull(seed.vertices, lamp, room);
  };
  return fit;
}

// Root mean square distance of the light's highlights on the surface from their middle.
double Spread(const std::vector<LightObservation>& of_light) {
  if (of_light.empty()) return 0;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  double squares = 0;
  for (const LightObservation& o : of_light) mean += o.position / static_cast<double>(of_light.size());
  for (const LightObservation& o : of_light) squares += (o.position - mean).squaredNorm();
  return std::sqrt(squares / static_cast<double>(of_light.size()));
}

std::vector<LightObservation> OfLight(const std::vector<LightObservation>& observations,
                                      const std::vector<int>& assignment, int light) {
  std::vector<LightObservation> of_light;
  for (size_t i = 0; i < observations.size(); ++i)
    if (assignment[i] == light) of_light.push_back(observations[i]);
  return of_light;
}

std::vector<char> ViewsThatShow(size_t num_views, const std::vector<Highlight>& of_light) {
  std::vector<char> shows(num_views, 0);
  for (const Highlight& h : of_light) shows[h.view] = 1;
  return shows;
}

// A light that does not shine in all groups says where it does; only there it is expected.
void LimitToGroups(const Scene& scene, const LightGroups& groups, size_t k, Light& light, std::vector<char>& expected) {
  if (groups.count == 1) return;
  for (size_t v = 0; v < scene.views.size(); ++v) {
    if (groups.shines[groups.group_of_view[v]][k])
      light.images.push_back(scene.views[v].name);
    else
      expected[v] = 0;
  }
  if (light.images.size() == scene.views.size()) light.images.clear();
}

std::vector<std::string> Names(const Scene& scene) {
  std::vector<std::string> names;
  for (const View& view : scene.views) names.push_back(view.name);
  return names;
}

}  // namespace

std::vector<FoundLight> FindLights(const Scene& scene, const ImageSource& images, const TriangleMesh& seed,
                                   const GateOptions& gate, const FindLightsOptions& options,
                                   const std::vector<Highlight>& candidates, FindLightsSummary* summary,
                                   Progress& progress) {
  GLINT_CHECK_EQ(images.size(), scene.views.size());
  GLINT_CHECK(!seed.empty());
  const double diagonal = Diagonal(seed);
  ViewBrightness brightness(images, size_t(gate.image_memory_mb) << 20, progress);
  brightness.Equalise(RelativeExposures(scene, brightness));
  const SeedSurface surface(seed, scene.points, gate.seed_error_rel * diagonal);
  FindLightsSummary told;
  for (const Highlight& h : candidates) told.candidates += h.status == HighlightStatus::kAccepted;

  // A light that moves with the camera is first taken for a flash; what it really is says better how it shades paint.
  std::vector<Light> moving_lights = {{LightType::kPoint, LightFrame::kCamera, Eigen::Vector3d::Zero(), 0}};
  LightFit fit;
  std::vector<LightObservation> observations;
  std::vector<Moving> moving;
  BrightSpots spots;
  for (int pass = 0; pass < kPasses; ++pass) {
    moving = FindMoving(scene, brightness, surface, gate, candidates, moving_lights, spots.stay_put, progress);
    told.not_paint = moving.size();
    moving = Strongest(candidates, brightness, std::move(moving), gate.min_relative_strength, options.max_candidates);
    observations = Observe(scene, surface, candidates, moving);
    fit = FitLights(observations, BoundingBox(seed).center(), diagonal, FitOptions(gate, options, seed));
    moving_lights.resize(1);
    for (const FoundLight& f : fit.lights)
      if (f.light.frame == LightFrame::kCamera) moving_lights.push_back(f.light);
    if (moving_lights.size() == 1) break;
  }
  const std::vector<Eigen::Vector3d> normals = SmoothNormals(seed);
  const auto of_light = [&](size_t k) {
    std::vector<Highlight> highlights;
    for (size_t i = 0; i < moving.size(); ++i)
      if (fit.assignment[i] == static_cast<int>(k)) highlights.push_back(candidates[moving[i].candidate]);
    return highlights;
  };
  std::vector<LightShows> shows;
  for (size_t k = 0; k < fit.lights.size(); ++k)
    shows.push_back({ViewsThatShouldShow(scene, surface, seed, normals, fit.lights[k].light, gate.max_incidence_deg),
                     ViewsThatShow(scene.views.size(), of_light(k))});
  const LightGroups groups = GroupViewsByLight(shows, OrderByNumbers(Names(scene)));
  told.groups = DescribeGroups(groups, Names(scene));
  std::vector<LightEvidence> evidence;
  for (size_t k = 0; k < fit.lights.size(); ++k) {
    FoundLight f = fit.lights[k];
    LimitToGroups(scene, groups, k, f.light, shows[k].expected);
    MeasureSize(scene, surface, of_light(k), BoundingBox(seed).center(), f);
    const auto seen = OfLight(observations, fit.assignment, static_cast<int>(k));
    evidence.push_back({Spread(seen),
                        static_cast<int>(std::count(shows[k].expected.begin(), shows[k].expected.end(), 1)),
                        WidthsDeg(scene, surface, of_light(k), f.light),
                        HalfVectorSigma(seen, fit.lights[k].covariance, diagonal, f.light) * 180 / M_PI});
    MeasureOff(scene, surface, of_light(k), fit.lights, evidence.back());
    told.lights.push_back(f);
  }
  JudgeLights(evidence, diagonal, options, told.lights);
  std::stable_partition(told.lights.begin(), told.lights.end(), [](const FoundLight& f) { return f.determined; });
  told.outlier_share = fit.outlier_share;
  spots.views = scene.views.size(), spots.moving = told.not_paint, spots.voting = observations.size();
  told.mirror_like = NotHighlights(spots, told.lights);
  if (summary) *summary = told;
  return told.lights;
}

}  // namespace glint
