// A highlight as an oriented ray [SAH03, DESIGN 3.2]: it fixes the surface normal where its viewing ray meets the
// surface, but not the depth. A contact is such a ray with the current estimate of that depth.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "colmap/scene.h"
#include "core/options.h"
#include "highlights/highlight.h"
#include "light/light.h"

namespace glint {

// Lengths in world units, angles in radians.
struct Contact {
  uint32_t highlight = 0;     // index into the list of highlights
  uint32_t view = 0;          // index into Scene::views
  int light = 0;              // index into the list of lights
  Rigid3d cam_from_world;     // of the view
  Eigen::Vector3d origin;     // camera centre
  Eigen::Vector3d direction;  // unit, from the camera through the highlight
  double depth = 0;           // the contact is origin + depth * direction
  double prior_depth = 0;     // depth at which the ray meets the current surface
  // Of the current surface where the ray meets it; zero: not to be relied on.
  Eigen::Vector3d surface_normal = Eigen::Vector3d::Zero();
  double sigma_normal = 0;  // standard deviation of the normal
  double sigma_depth = 0;   // from the bundle's covariance; 0: not known yet
  double pixel_angle = 0;   // angle that the peak's standard deviation in pixels subtends
  // Rays through the ends of the blob's two axes, one standard deviation from the peak: +a, -a, +b, -b; unit.
  std::array<Eigen::Vector3d, 4> axis_rays;
  bool accepted = true;
  HighlightStatus reason = HighlightStatus::kInconsistent;  // where it is not accepted

  Eigen::Vector3d Position() const { return origin + depth * direction; }
  Eigen::Vector3d SurfacePosition() const { return origin + prior_depth * direction; }
};

// Half vector at the contact's current position: the surface normal there.
Eigen::Vector3d ContactNormal(const Contact& contact, const Light& light);

// Incidence angle at the contact (between normal and viewing direction), radians.
double Incidence(const Contact& contact, const Light& light);

struct ContactOptions {
  double sigma_normal_deg = 0.25;
  double max_incidence_deg = 65;
  void Visit(OptionVisitor& v);
};

// One contact for every accepted highlight with a light; depths are zero until an intersection sets them.
std::vector<Contact> MakeContacts(const Scene& scene, const std::vector<Highlight>& highlights,
                                  const ContactOptions& options);

}  // namespace glint
