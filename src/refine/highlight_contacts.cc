#include "refine/highlight_contacts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/median.h"
#include "geometry/point_index.h"
#include "refine/turn.h"

namespace glint {
namespace {

constexpr double kRadians = M_PI / 180;
// A highlight narrower than this share of what the surface would make of the usual lobe lies elsewhere.
constexpr double kMinWidthShare = 0.45;
// Nor does one that is wider by this factor: the surface is sharper there than the highlight says.
constexpr double kMaxWidthShare = 4;
// A highlight that was left out for its size comes back only when it fits clearly, so that it does not come and go.
constexpr double kReturnMargin = 1.5;
// Standard deviation of a normal at a blob's end: the blob is not quite the lobe's.
constexpr double kLeastLobeSigma = 0.25 * kRadians;
constexpr double kLobeSigmaShare = 0.08;
// The errors of the bundle's depths are alike over whole regions, which their standard deviations do not say. Where
// points are dense they decide; far from points the bundle does.
constexpr double kBundleCaution = 3;
constexpr double kLeastBundleSigma = 0.002;
// A normal holds where the bundle has its contact and is imposed where its ray meets the surface. So far as these
// differ, and the surface turns sharply from the one to the other (a lip), it says less.
constexpr double kGentle = 20;  // curvature, 1 / diagonal: what turns no faster is no lip
constexpr double kTurnVoxels = 1.5;

// Standard deviation of the direction to the light at a contact, radians.
double DirectionSigma(const Light& light, const Contact& contact) {
  if (light.type == LightType::kDistant) return light.sigma * kRadians;
  const Eigen::Vector3d position =
      light.frame == LightFrame::kWorld ? light.vector : contact.cam_from_world.Inverse() * light.vector;
  return light.sigma / std::max((position - contact.Position()).norm(), light.sigma);
}

}  // namespace

HighlightContacts::HighlightContacts(std::vector<Contact> contacts, std::vector<Light> lights,
                                     std::vector<bool> solve_lights, bool use_lobes)
    : contacts_(std::move(contacts)),
      lights_(std::move(lights)),
      known_lights_(lights_),
      solve_lights_(std::move(solve_lights)),
      use_lobes_(use_lobes),
      misfit_(contacts_.size(), 0),
      curvature_(contacts_.size(), 0),
      lobes_(contacts_.size()) {}

double HighlightContacts::Follow(const TriangleMesh& surface, const LevelSet& field, bool reliable_normals,
                                 double max_incidence, const std::vector<SurfacePoint>& points,
                                 const BundleOptions& options, BundleSummary& summary) {
  const RayCaster caster(surface);
  const SurfaceQuery query(surface);
  std::vector<double> surface_motion = LayOn(caster, field, reliable_normals, max_incidence);
  MeasureLobes(surface, caster);
  std::vector<double> before, motion;
  for (const Contact& contact : contacts_) before.push_back(contact.depth);
  summary = SolveBundle(points, 1.0, solve_lights_, options, contacts_, lights_, &known_lights_, &query);
  for (size_t i = 0; i < contacts_.size(); ++i)
    if (contacts_[i].accepted) motion.push_back(std::abs(contacts_[i].depth - before[i]));
  return std::max(Median(motion), Median(surface_motion));
}

// Returns how far those on the surface before and now moved.
std::vector<double> HighlightContacts::LayOn(const RayCaster& caster, const LevelSet& field, bool reliable_normals,
                                             double max_incidence) {
  std::vector<double> motion;
  num_on_surface_ = 0;
  for (size_t i = 0; i < contacts_.size(); ++i) {
    Contact& contact = contacts_[i];
    contact.accepted = false;
    contact.reason = HighlightStatus::kInconsistent;
    const auto hit = caster.Intersect(contact.origin, contact.direction);
    if (!hit) {
      contact.reason = HighlightStatus::kOffSurface;
      continue;
    }
    if (contact.prior_depth > 0) motion.push_back(std::abs(hit->t - contact.prior_depth));
    contact.prior_depth = hit->t;
    const Eigen::Vector3d normal = field.Gradient(hit->position).normalized();
    if (reliable_normals) contact.surface_normal = normal;
    const double reach = kTurnVoxels * field.voxel_size();
    curvature_[i] = LargestTurn(field, hit->position, normal, reach) / (2 * reach);
    if (contact.depth == 0) contact.depth = hit->t;
    contact.accepted = Incidence(contact, lights_[contact.light]) < max_incidence;
    num_on_surface_ += contact.accepted;
  }
  return motion;
}

// A much smaller highlight than the surface would make comes from a sharper place (a rim, a handle) that the seed does
// not have, and its ray meets the surface behind.
void HighlightContacts::MeasureLobes(const TriangleMesh& surface, const RayCaster& caster) {
  std::vector<double> widths;
  for (size_t i = 0; i < contacts_.size(); ++i) {
    lobes_[i].reset();
    if (!contacts_[i].accepted) continue;
    lobes_[i] = LayLobe(contacts_[i], lights_[contacts_[i].light], surface, caster);
    if (lobes_[i]) widths.push_back(lobes_[i]->Width());
  }
  lobe_width_ = Median(widths);
  for (size_t i = 0; i < contacts_.size(); ++i) {
    if (!lobes_[i]) continue;
    const auto [least, most] = std::minmax({lobes_[i]->turn.col(0).norm(), lobes_[i]->turn.col(1).norm()});
    const double margin = misfit_[i] ? kReturnMargin : 1;
    misfit_[i] = least < margin * kMinWidthShare * lobe_width_ || margin * most > kMaxWidthShare * lobe_width_;
    if (!misfit_[i]) continue;
    contacts_[i].accepted = false;
    contacts_[i].reason = HighlightStatus::kWrongSize;
  }
}

// The ends of each blob's axes, whose normals its size tells: what the peaks say of the slopes, these say of the
// curvatures.
void HighlightContacts::AddLobes(std::vector<OrientedPoint>& oriented) const {
  const double sigma = std::max(kLeastLobeSigma, kLobeSigmaShare * lobe_width_);
  size_t parent = 0;
  for (size_t i = 0; i < contacts_.size(); ++i) {
    if (!contacts_[i].accepted) continue;
    const OrientedPoint peak = oriented[parent++];
    if (!lobes_[i]) continue;
    const std::array<Eigen::Vector3d, 4> normals = lobes_[i]->NormalsAtEnds(lobe_width_);
    for (int k = 0; k < 4; ++k) {
      OrientedPoint end = peak;
      end.position = lobes_[i]->position[k];
      end.normal = normals[k];
      end.sigma_position = 0;
      end.sigma_normal = std::hypot(peak.sigma_normal, sigma);
      oriented.push_back(end);
    }
  }
}

std::vector<OrientedPoint> HighlightContacts::Oriented() const {
  std::vector<OrientedPoint> oriented;
  for (size_t i = 0; i < contacts_.size(); ++i) {
    const Contact& contact = contacts_[i];
    if (!contact.accepted) continue;
    OrientedPoint p;
    p.position = contact.SurfacePosition();
    p.bundle_position = contact.Position();
    p.normal = ContactNormal(contact, lights_[contact.light]);
    const double facing = std::abs(contact.direction.dot(p.normal));
    p.sigma_position = std::clamp(kBundleCaution * contact.sigma_depth * facing, kLeastBundleSigma, 0.03);
    const double sharper = std::max(0.0, curvature_[i] - kGentle);
    p.sigma_normal = std::max(contact.sigma_normal, std::abs(contact.prior_depth - contact.depth) * sharper);
    p.light = contact.light;
    p.sigma_light = 0.5 * DirectionSigma(lights_[contact.light], contact);
    oriented.push_back(p);
  }
  // A contact explains the surface as far as the next few contacts are.
  constexpr int kNear = 6;
  std::vector<Eigen::Vector3d> positions;
  for (const OrientedPoint& p : oriented) positions.push_back(p.position);
  const PointIndex index(positions);
  for (OrientedPoint& p : oriented) {
    const int last = index.Nearest(p.position, kNear + 1).back();  // the first is the contact itself
    p.reach = std::clamp((positions[last] - p.position).norm(), 0.02, 0.12);
  }
  if (use_lobes_) AddLobes(oriented);
  return oriented;
}

}  // namespace glint
