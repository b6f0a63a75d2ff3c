#include "constraints/contact.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace glint {

void ContactOptions::Visit(OptionVisitor& v) {
  v.Field({.name = "sigma_normal_deg",
           .help = "standard deviation of a highlight's normal apart from its peak's uncertainty in the image",
           .unit = "deg",
           .min = 0.01,
           .max = 20},
          sigma_normal_deg);
  v.Field({.name = "max_incidence_deg",
           .help = "highlights seen at a larger angle from the normal are left out: off-specular peak, Fresnel",
           .unit = "deg",
           .min = 5,
           .max = 90},
          max_incidence_deg);
}

Eigen::Vector3d ContactNormal(const Contact& contact, const Light& light) {
  return HalfVector(light, contact.cam_from_world, contact.Position());
}

double Incidence(const Contact& contact, const Light& light) {
  return std::acos(std::clamp(-contact.direction.dot(ContactNormal(contact, light)), -1.0, 1.0));
}

namespace {

bool SetAxisRays(const View& view, const Highlight& highlight, Contact& contact) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(highlight.moments_px);
  for (int k = 0; k < 4; ++k) {
    const double length_px = (k % 2 ? -1 : 1) * std::sqrt(std::max(axes.eigenvalues()[k / 2], 0.0));
    const auto ray = view.RayThrough(highlight.px + length_px * axes.eigenvectors().col(k / 2));
    if (!ray) return false;
    contact.axis_rays[k] = *ray;
  }
  return true;
}

}  // namespace

std::vector<Contact> MakeContacts(const Scene& scene, const std::vector<Highlight>& highlights,
                                  const ContactOptions& options) {
  constexpr double kRadians = M_PI / 180;
  std::vector<Contact> contacts;
  for (size_t i = 0; i < highlights.size(); ++i) {
    const Highlight& highlight = highlights[i];
    if (highlight.status != HighlightStatus::kAccepted || highlight.light < 0) continue;
    const View& view = scene.views[highlight.view];
    const auto ray = view.RayThrough(highlight.px);
    if (!ray) continue;
    Contact contact;
    contact.highlight = static_cast<uint32_t>(i);
    contact.view = highlight.view;
    contact.light = highlight.light;
    contact.cam_from_world = view.cam_from_world;
    contact.origin = view.Center();
    contact.direction = *ray;
    contact.sigma_normal = options.sigma_normal_deg * kRadians;
    const double sigma_px = std::sqrt(std::max(0.0, 0.5 * highlight.covariance_px.trace()));
    contact.pixel_angle = sigma_px / MeanFocalLength(view.camera);
    if (!SetAxisRays(view, highlight, contact)) continue;
    contacts.push_back(contact);
  }
  return contacts;
}

}  // namespace glint
