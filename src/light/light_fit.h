// Unknown lights from surface normals under highlights: how many, of which kind, where.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "geometry/rigid.h"
#include "light/found_light.h"
#include "light/light.h"

namespace glint {

// One highlight: its view, and what is believed of the surface under it. It may be an outlier.
struct LightObservation {
  Rigid3d cam_from_world;
  Eigen::Vector3d position;
  Eigen::Vector3d normal;  // unit, outward
  bool may_move = true;    // false: an outlier if there is a light that moves with the camera
  bool outlier = false;    // supports no light
};

struct LightFitOptions {
  int max_lights = 6;
  int min_support = 5;  // highlights a light needs
  double max_incidence_deg = 65;
  double max_normal_sigma_deg = 5;  // what agrees with the normals no better is a crowd of marks, not a light
  bool allow_distant = true;
  bool allow_point = true;
  bool allow_world = true;
  bool allow_camera = true;
  // Where a lamp that stands still may be, in the world; empty: anywhere.
  std::function<bool(const Eigen::Vector3d&)> may_be_at = {};
};

struct LightFit {
  std::vector<FoundLight> lights;  // by falling support
  std::vector<int> assignment;     // light of each observation, -1: outlier
  double normal_sigma_deg = 0;     // of the normals' disagreement with the half vectors
  double outlier_share = 0;
};

// A mixture of lights and uniform outliers on the normals, l = 2 (n·v) n − v [DESIGN 3.3]: lights are added one by one
// from the best of a grid of directions in the world's and in the camera's frame and the camera itself (flash),
// refined by expectation maximisation, and kept while the Bayesian information criterion falls; then each is tried as
// a near one. That some light moves with the camera is a hypothesis of its own: then all that may be paint under such
// a light counts as outliers. Of two hypotheses what they say of lights counts, not of crowds of marks. A point light
// in the camera's frame is expected near the camera; one in the world where options.may_be_at allows it. `center`,
// `diagonal`: of the object, for the scale of positions.
LightFit FitLights(const std::vector<LightObservation>& observations, const Eigen::Vector3d& center, double diagonal,
                   const LightFitOptions& options);

// Angle (radians) between half vector and normal; pi where the incidence is above the limit.
double Disagreement(const LightObservation& observation, const Light& light, double max_incidence_deg);

}  // namespace glint
