#include "refine/surface_constraints.h"

#include <array>
#include <cmath>

#include "core/square.h"

namespace glint {
namespace {

// Standard deviation of a contact's footprint: a share of the distance to the next contacts.
constexpr double kFootprintShare = 0.1;
constexpr double kLeastFootprintVoxels = 0.6;
constexpr double kFootprintReach = 2.2;  // standard deviations
// Of a tilt's direction across the normal: with less, the normal may turn either way.
constexpr double kLeastLever = 0.15;

// A normal that is off the current one by more (47 degrees) lies on another surface, or the light is not its own:
// trusted, it would be met by a fold, which no later solve takes back.
constexpr double kMostTurn = 0.8;

// Weights of a squared residual in standard deviations. Contacts: Cauchy, they were judged in the bundle already.
// Points: Geman and McClure, which lets go of the few that lie centimetres off.
double ContactWeight(double squared) { return 1 / (1 + squared / 4); }
double PointWeight(double squared) { return 1 / ((1 + squared / 9) * (1 + squared / 9)); }

bool AddValueRow(const Band& band, const Eigen::Vector3d& x, double weight, RowBuilder& row, BandRows& rows) {
  std::array<int32_t, 8> voxels;
  std::array<double, 8> weights;
  if (!band.Trilinear(x, voxels, weights)) return false;
  for (int k = 0; k < 8; ++k) row.Push(voxels[k], weights[k]);
  row.Close(0, weight, rows);
  return true;
}

struct Tap {
  int32_t voxel;
  double weight;
};

// Voxels of a ball about x with Gaussian weights that sum to 1; empty if none has all its neighbours.
std::vector<Tap> GaussianTaps(const Band& band, const Eigen::Vector3d& x, double sigma_voxels) {
  std::vector<Tap> taps;
  double sum = 0;
  band.ForVoxelsInBall(x, kFootprintReach * sigma_voxels, [&](int32_t v, double squared) {
    if (!band.HasAllNeighbors(v)) return;
    taps.push_back({v, std::exp(-0.5 * squared / (sigma_voxels * sigma_voxels))});
    sum += taps.back().weight;
  });
  for (Tap& tap : taps) tap.weight /= sum;
  return taps;
}

Eigen::Vector3d GradientOf(const Band& band, const std::vector<Tap>& taps) {
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  for (const Tap& tap : taps)
    for (int axis = 0; axis < 3; ++axis)
      gradient[axis] +=
          tap.weight * (band.phi()[band.Neighbor(tap.voxel, axis, 1)] - band.phi()[band.Neighbor(tap.voxel, axis, 0)]);
  return gradient / (2 * band.voxel_size());
}

// The normal at a contact, as the field's mean gradient over a footprint: a gradient at a mere point costs a smooth
// field almost nothing, it would answer with a spike. What the current field's mean over the footprint differs from
// its gradient at the point is carried over, so that at convergence it is the gradient at the point that agrees.
bool AddGradientRows(const Band& band, const OrientedPoint& contact, double weight, RowBuilder& row, BandRows& rows) {
  const double footprint = kFootprintShare * contact.reach / band.voxel_size();
  const std::vector<Tap> mean = GaussianTaps(band, contact.position, std::max(footprint, kLeastFootprintVoxels));
  std::array<int32_t, 8> voxels;
  std::array<double, 8> weights;
  if (mean.empty() || !band.Trilinear(contact.position, voxels, weights)) return false;
  std::vector<Tap> point;
  for (int k = 0; k < 8; ++k) {
    if (!band.HasAllNeighbors(voxels[k])) return false;
    point.push_back({voxels[k], weights[k]});
  }
  const Eigen::Vector3d target = contact.normal + GradientOf(band, mean) - GradientOf(band, point);
  for (int axis = 0; axis < 3; ++axis) {
    for (const Tap& tap : mean) {
      const double c = tap.weight / (2 * band.voxel_size());
      row.Push(band.Neighbor(tap.voxel, axis, 1), c);
      row.Push(band.Neighbor(tap.voxel, axis, 0), -c);
    }
    row.Close(target[axis], weight, rows);
  }
  return true;
}

}  // namespace

void SurfaceConstraints::AddContacts(const std::vector<OrientedPoint>& contacts, double weight) {
  if (weight == 0) return;
  for (size_t i = 0; i < contacts.size(); ++i) {
    const OrientedPoint& contact = contacts[i];
    size_t first = rows_.size();
    if (!AddGradientRows(band_, contact, weight / Square(contact.sigma_normal), row_, rows_)) {
      ++contacts_off_band_;
      continue;
    }
    EndGroup(first, false, static_cast<int>(i));
    first = rows_.size();
    if (contact.sigma_position > 0 &&
        AddValueRow(band_, contact.bundle_position, weight / Square(contact.sigma_position), row_, rows_))
      EndGroup(first, false);
  }
}

void SurfaceConstraints::AddPoints(const std::vector<SurfacePoint>& points, double weight) {
  if (weight == 0) return;
  for (const SurfacePoint& point : points) {
    const size_t first = rows_.size();
    if (AddValueRow(band_, point.position, weight / Square(point.sigma), row_, rows_))
      EndGroup(first, true);
    else
      ++points_off_band_;
  }
}

void SurfaceConstraints::AddOutline(const std::vector<OrientedPoint>& touched, double weight) {
  if (weight == 0) return;
  for (const OrientedPoint& place : touched) {
    const size_t first = rows_.size();
    AddValueRow(band_, place.bundle_position, weight / Square(place.sigma_position), row_, rows_);
    AddGradientRows(band_, place, weight / Square(place.sigma_normal), row_, rows_);
    EndGroup(first, true);
  }
}

// A unit normal can only turn: what a tilt says along the normal as it is now would stretch the field instead.
void SurfaceConstraints::AddTilts(const std::vector<Tilt>& tilts) {
  for (const Tilt& tilt : tilts) {
    const double footprint = std::max(0.5 * tilt.radius_world / band_.voxel_size(), kLeastFootprintVoxels);
    const std::vector<Tap> mean = GaussianTaps(band_, tilt.position, footprint);
    const Eigen::Vector3d normal = GradientOf(band_, mean).normalized();
    const Eigen::Vector3d across = tilt.direction - normal.dot(tilt.direction) * normal;
    const double lever = across.norm();
    if (mean.empty() || !(lever > kLeastLever)) continue;
    const size_t first = rows_.size();
    for (const Tap& tap : mean)
      for (int axis = 0; axis < 3; ++axis) {
        const double c = across[axis] / lever * tap.weight / (2 * band_.voxel_size());
        row_.Push(band_.Neighbor(tap.voxel, axis, 1), c);
        row_.Push(band_.Neighbor(tap.voxel, axis, 0), -c);
      }
    const double sigma = tilt.sigma / lever;
    row_.Close((tilt.cosine - normal.dot(tilt.direction)) / lever, tilt.share / (sigma * sigma), rows_);
    EndGroup(first, true, -1, tilt.share);
  }
}

void SurfaceConstraints::EndGroup(size_t first, bool is_point, int contact, double share) {
  for (size_t r = first; r < rows_.size(); ++r) base_weight_.push_back(rows_.weight[r]);
  groups_.push_back({first, rows_.size(), is_point, contact, share});
}

std::vector<double> SurfaceConstraints::RobustWeights(const std::vector<double>& phi, bool trust_contacts) const {
  std::vector<double> weights(rows_.size());
  for (const auto& [first, last, is_point, contact, share] : groups_) {
    double squared = 0, raw = 0;
    for (size_t r = first; r < last; ++r) {
      const double residual = rows_.Dot(r, phi) - rows_.target[r];
      squared += base_weight_[r] * residual * residual;
      raw += residual * residual;
    }
    squared /= share;
    const bool trusted = trust_contacts && (contact < 0 || raw < kMostTurn * kMostTurn);
    const double weight = is_point ? PointWeight(squared) : (trusted ? 1 : ContactWeight(squared));
    for (size_t r = first; r < last; ++r) weights[r] = weight * base_weight_[r];
  }
  return weights;
}

std::vector<double> SurfaceConstraints::LightNoise(const std::vector<OrientedPoint>& contacts,
                                                   const std::vector<Eigen::Vector3d>& off) const {
  std::vector<double> noise(rows_.size(), 0);
  for (const Group& group : groups_) {
    if (group.contact < 0) continue;
    const OrientedPoint& c = contacts[group.contact];
    if (c.light < 0 || c.sigma_light == 0) continue;
    const Eigen::Vector3d turned = c.sigma_light * (off[c.light] - c.normal * c.normal.dot(off[c.light]));
    for (int axis = 0; axis < 3; ++axis) noise[group.first + axis] = turned[axis];
  }
  return noise;
}

}  // namespace glint
