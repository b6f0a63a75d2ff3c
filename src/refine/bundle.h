// The specular bundle (DESIGN 3.3): depths of the contacts, and the lights unless they are fixed, from the
// integrability of neighbouring contacts, reliable surface points and a weak prior to the current surface.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "constraints/contact.h"
#include "core/options.h"
#include "geometry/closest_point.h"
#include "light/light.h"

namespace glint {

// A point known to lie on the surface, with the current surface's normal there. World units.
struct SurfacePoint {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  double sigma = 0;                                            // standard deviation of the position
  Eigen::Vector3d surface_position = Eigen::Vector3d::Zero();  // foot point on the current surface
};

struct BundleOptions {
  int neighbors = 12;
  double max_normal_angle_deg = 35;
  double prior_sigma_rel = 0.03;
  double point_normal_sigma_deg = 5;
  double reject_sigmas = 3;
  int rounds = 4;
  void Visit(OptionVisitor& v);
};

struct BundleLightUpdate {
  double change = 0;  // degrees (distant) or fraction of the diagonal (point)
  double sigma = 0;   // the same units; 0: fixed
  int contacts = 0;   // that support it
};

struct BundleSummary {
  int num_contacts = 0;
  int num_chords = 0;
  int num_point_chords = 0;
  int num_rejected = 0;
  double initial_cost = 0;
  double final_cost = 0;
  double motion_rel = 0;        // median motion of the contacts, fraction of the diagonal
  double chord_rms_sigmas = 0;  // of the accepted contacts' chords, in their standard deviations
  std::vector<BundleLightUpdate> lights;
  bool usable = true;
  std::string message;  // Ceres' brief report of the last solve
};

// The current surface, to ask for its nearest place.
struct SurfaceQuery {
  explicit SurfaceQuery(const TriangleMesh& surface) : mesh(surface), closest(surface) {}
  const TriangleMesh& mesh;
  ClosestPointQuery closest;
};

// Moves `contacts` (depth, sigma_depth, accepted) and, where solve_lights[k] is set, `lights[k]`. `diagonal` is the
// object's bounding-box diagonal in world units. A solved light with a sigma is held to `known_lights` (null: to where
// it starts), so that solving again and again does not let it drift. Chords that leave `surface`, the current one, are
// not drawn: what they would tie lies on either side of a gap or a fold. Deterministic.
BundleSummary SolveBundle(const std::vector<SurfacePoint>& points, double diagonal,
                          const std::vector<bool>& solve_lights, const BundleOptions& options,
                          std::vector<Contact>& contacts, std::vector<Light>& lights,
                          const std::vector<Light>* known_lights = nullptr, const SurfaceQuery* surface = nullptr);

}  // namespace glint
