#include "refine/chords.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/median.h"
#include "refine/neighbors.h"

namespace glint {
namespace {

constexpr double kRadians = M_PI / 180;
// Share of the squared angle between two normals that a chord may be off by because curvature changes along it.
constexpr double kCurvatureChange = 0.1;
// What of that is left once the current surface's own offset is taken off.
constexpr double kCorrected = 0.3;
// How far the surface may be from the middle of a chord: times its sag, and of the diagonal beyond that.
constexpr double kSagShare = 2, kSheetRel = 0.01, kSheetCosine = 0.5;
constexpr int kPointNeighbors = 6;

// What (m_a + m_b)/|m_a + m_b| · (s_b − s_a) is on the current surface; none where its normals are not to be relied on.
std::optional<double> SurfaceOffset(const Eigen::Vector3d& s_a, const Eigen::Vector3d& m_a, const Eigen::Vector3d& s_b,
                                    const Eigen::Vector3d& m_b) {
  if (m_a.isZero() || m_b.isZero()) return std::nullopt;
  return (m_a + m_b).normalized().dot(s_b - s_a);
}

// Whether the surface follows the chord between two places on it with these normals, as far as its bend lets it: a
// chord of length c whose normals differ by θ sags by cθ/8, and the normals on the way lie between them.
bool OnOneSheet(const SurfaceQuery& surface, const Eigen::Vector3d& a, const Eigen::Vector3d& normal_a,
                const Eigen::Vector3d& b, const Eigen::Vector3d& normal_b, double diagonal) {
  const double angle = std::acos(std::clamp(normal_a.dot(normal_b), -1.0, 1.0));
  const double reach = kSagShare * (b - a).norm() * angle / 8 + kSheetRel * diagonal;
  const Eigen::Vector3d mean_normal = (normal_a + normal_b).normalized();
  for (const double t : {0.25, 0.5, 0.75}) {
    const auto near = surface.closest.Find(a + t * (b - a), reach);
    if (!near || FaceNormal(surface.mesh, near->face).dot(mean_normal) < kSheetCosine) return false;
  }
  return true;
}

// An end of a chord.
struct End {
  Eigen::Vector3d position, normal;
  Eigen::Vector3d on_surface, surface_normal;  // the current one; the normal may be zero
};

End At(const Contact& contact, const Light& light) {
  return {contact.Position(), ContactNormal(contact, light), contact.SurfacePosition(), contact.surface_normal};
}

End At(const SurfacePoint& point) { return {point.position, point.normal, point.surface_position, point.normal}; }

double Angle(const End& a, const End& b) { return std::acos(std::clamp(a.normal.dot(b.normal), -1.0, 1.0)); }

// The rule's own error along a chord, as an angle, and the current surface's offset.
struct RuleError {
  double angle, offset;
};
RuleError ErrorOfTheRule(const End& a, const End& b) {
  const double angle2 = 2 * (1 - std::clamp(a.normal.dot(b.normal), -1.0, 1.0));
  const auto offset = SurfaceOffset(a.on_surface, a.surface_normal, b.on_surface, b.surface_normal);
  return {(offset ? kCorrected : 1.0) * kCurvatureChange * angle2, offset.value_or(0)};
}

struct Places {
  explicit Places(const std::vector<End>& ends) {
    for (const End& end : ends) {
      positions.push_back(end.position);
      normals.push_back(end.normal);
    }
  }
  std::vector<Eigen::Vector3d> positions, normals;
};

}  // namespace

Chords MakeChords(const std::vector<Contact*>& contacts, const std::vector<Light>& lights,
                  const std::vector<SurfacePoint>& points, double diagonal, const BundleOptions& options,
                  const SurfaceQuery* surface) {
  std::vector<End> ends, point_ends;
  for (const Contact* c : contacts) ends.push_back(At(*c, lights[c->light]));
  for (const SurfacePoint& p : points) point_ends.push_back(At(p));
  const Places places(ends), point_places(point_ends);
  const auto leaves_sheet = [&](const End& a, const End& b) {
    return surface && !OnOneSheet(*surface, a.on_surface, a.normal, b.on_surface, b.normal, diagonal);
  };

  NeighborOptions near;
  near.count = options.neighbors;
  near.max_normal_angle = options.max_normal_angle_deg * kRadians;
  auto pairs = UniquePairs(SectorNeighbors(places.positions, places.normals, places.positions, places.normals, near));
  std::erase_if(pairs, [&](const auto& pair) { return leaves_sheet(ends[pair.first], ends[pair.second]); });

  std::vector<std::vector<double>> curvatures(contacts.size());
  for (const auto& [i, j] : pairs) {
    const double length = (ends[i].position - ends[j].position).norm();
    const double curvature = Angle(ends[i], ends[j]) / std::max(length, 1e-6 * diagonal);
    curvatures[i].push_back(curvature);
    curvatures[j].push_back(curvature);
  }
  std::vector<double> variance(contacts.size());
  for (size_t i = 0; i < contacts.size(); ++i) {
    const double shift = contacts[i]->pixel_angle * contacts[i]->depth * Median(curvatures[i]);
    variance[i] = contacts[i]->sigma_normal * contacts[i]->sigma_normal + shift * shift;
  }
  Chords chords;
  // Each normal enters about `neighbors` chords; the factor keeps the covariance honest.
  const double shared = std::sqrt(options.neighbors / 3.0);
  for (const auto& [i, j] : pairs) {
    const double length = (ends[i].position - ends[j].position).norm();
    const RuleError rule = ErrorOfTheRule(ends[i], ends[j]);
    const double sigma =
        length * std::sqrt((variance[i] + variance[j]) / 4 * shared * shared + rule.angle * rule.angle);
    chords.between.push_back({i, j, std::max(sigma, 1e-5 * diagonal), rule.offset});
  }
  if (points.empty()) return chords;
  near.count = kPointNeighbors;
  const auto near_points =
      SectorNeighbors(places.positions, places.normals, point_places.positions, point_places.normals, near);
  for (size_t i = 0; i < near_points.size(); ++i)
    for (const int p : near_points[i]) {
      if (leaves_sheet(ends[i], point_ends[p])) continue;
      const double length = (ends[i].position - points[p].position).norm();
      const RuleError rule = ErrorOfTheRule(ends[i], point_ends[p]);
      const double direction = std::hypot(0.5 * options.point_normal_sigma_deg * kRadians, rule.angle);
      chords.to_points.push_back(
          {static_cast<int>(i), p, std::hypot(length * direction, points[p].sigma), rule.offset});
    }
  return chords;
}

}  // namespace glint
