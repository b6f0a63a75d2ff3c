#include "seed/ray_votes.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "core/check.h"
#include "core/parallel.h"
#include "geometry/ray_caster.h"

namespace glint {
namespace {

constexpr size_t kGrain = 64;
constexpr int kMaxWithoutProgress = 64;  // cells in a row whose exits lie no farther along the ray
constexpr int kLost = -1;

void Add(int64_t& sum, int64_t vote) { std::atomic_ref<int64_t>(sum).fetch_add(vote, std::memory_order_relaxed); }

// How deep a direction lies in the cell's cone at one of its corners: sine of the least angle to the cone's three
// sides, negative outside. Signs come from the cell's exact orientation, so that a cell flat up to rounding is judged
// as well as any other.
double DepthInCone(const Tetrahedra& t, int cell, int corner, const Eigen::Vector3d& direction) {
  const Eigen::Vector3d apex = t.Corner(cell, corner);
  Eigen::Matrix3d edges;
  for (int k = 0; k < 3; ++k) edges.col(k) = t.Corner(cell, kOutwardFacet[corner][k]) - apex;
  double depth = 1;
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d inward = edges.col((k + 1) % 3).cross(edges.col((k + 2) % 3));
    const double length = inward.norm();
    if (!(length > 0)) return -1;
    depth = std::min(depth, direction.dot(inward) / length);
  }
  return depth;
}

struct Exit {
  int facet = -1;
  double t = 0;
};

// Where the ray from `origin` leaves a finite cell that it entered through facet `entry` (or started in a corner
// opposite to it, where every other facet touches the origin and only `entry` can be left through).
Exit LeavingFacet(const Tetrahedra& tets, int cell, int entry, const Eigen::Vector3d& origin,
                  const Eigen::Vector3d& direction) {
  Exit best;
  best.t = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 4; ++k) {
    if (k == entry) continue;
    const Eigen::Vector3d a = tets.Corner(cell, kOutwardFacet[k][0]);
    const Eigen::Vector3d n =
        (tets.Corner(cell, kOutwardFacet[k][1]) - a).cross(tets.Corner(cell, kOutwardFacet[k][2]) - a);
    const double speed = direction.dot(n);
    if (speed <= 0) continue;
    const double t = (a - origin).dot(n) / speed;
    if (t < best.t) best = {k, t};
  }
  return best;
}

// Follows a ray from `exit` of `cell` on; visit(cell, facet, t) at every facet that is left, and returns the cell at
// distance t_end from the origin: an infinite cell if the hull ends before, kLost if rounding leads round in circles
// among flat cells or leaves no way on.
template <class Visit>
int Follow(const Tetrahedra& tets, int cell, Exit exit, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
           double t_end, const Visit& visit) {
  double farthest = -std::numeric_limits<double>::infinity();
  for (int without_progress = 0; without_progress < kMaxWithoutProgress; ++without_progress) {
    if (exit.facet < 0) return kLost;
    if (!(exit.t < t_end)) return cell;
    if (exit.t > farthest) {
      farthest = exit.t;
      without_progress = 0;
    }
    visit(cell, exit.facet, exit.t);
    const int next = tets.neighbors[cell][exit.facet];
    if (tets.IsInfinite(next)) return next;
    int entry = 0;
    while (tets.neighbors[next][entry] != cell) ++entry;
    cell = next;
    exit = LeavingFacet(tets, cell, entry, origin, direction);
  }
  return kLost;
}

// The same from a corner of the triangulation. A point on the hull may look outward: into one of its infinite cells.
template <class Visit>
int FollowFromPoint(const Tetrahedra& tets, const std::vector<int>& around, int point, const Eigen::Vector3d& direction,
                    double t_end, const Visit& visit) {
  int cell = kLost, infinite = kLost;
  double best = -std::numeric_limits<double>::infinity();
  for (int c : around) {
    if (tets.IsInfinite(c)) {
      infinite = c;
      continue;
    }
    const double depth = DepthInCone(tets, c, tets.CornerOf(c, point), direction);
    if (depth > best) {
      best = depth;
      cell = c;
    }
  }
  // Rounding: a ray along a facet belongs to either side, and inside the hull to one of the cells in any case.
  if (infinite != kLost && best < -1e-9) return infinite;
  if (cell == kLost) return kLost;
  const int facet = tets.CornerOf(cell, point);
  const Eigen::Vector3d& origin = tets.points[point];
  const Eigen::Vector3d a = tets.Corner(cell, kOutwardFacet[facet][0]);
  const Eigen::Vector3d n =
      (tets.Corner(cell, kOutwardFacet[facet][1]) - a).cross(tets.Corner(cell, kOutwardFacet[facet][2]) - a);
  return Follow(tets, cell, {facet, (a - origin).dot(n) / direction.dot(n)}, origin, direction, t_end, visit);
}

// Finds where lines enter the convex hull.
class Hull {
 public:
  explicit Hull(const Tetrahedra& tets) : tets_(tets), caster_(Border(tets, facets_)) {
    for (const Eigen::Vector3d& p : tets.points) box_.extend(p);
  }

  // Follows the whole line through `from` along `direction`; visit(cell, facet, t) with t measured from `from`.
  template <class Visit>
  void FollowLine(const Eigen::Vector3d& from, const Eigen::Vector3d& direction, double t_end,
                  const Visit& visit) const {
    const double before = (from - box_.center()).norm() + box_.diagonal().norm();
    const std::optional<RayHit> hit = caster_.Intersect(from - before * direction, direction);
    if (!hit || hit->t - before > t_end) return;
    const auto& [cell, facet] = facets_[hit->face];
    Follow(tets_, cell, LeavingFacet(tets_, cell, facet, from, direction), from, direction, t_end, visit);
  }

 private:
  static TriangleMesh Border(const Tetrahedra& tets, std::vector<std::pair<int, int>>& facets) {
    TriangleMesh mesh;
    mesh.vertices = tets.points;
    for (int c = 0; c < static_cast<int>(tets.cells.size()); ++c)
      for (int k = 0; k < 4 && !tets.IsInfinite(c); ++k) {
        if (!tets.IsInfinite(tets.neighbors[c][k])) continue;
        facets.emplace_back(c, k);
        const auto& corner = kOutwardFacet[k];
        mesh.faces.emplace_back(tets.cells[c][corner[0]], tets.cells[c][corner[1]], tets.cells[c][corner[2]]);
      }
    return mesh;
  }

  const Tetrahedra& tets_;
  std::vector<std::pair<int, int>> facets_;  // finite cell and facet, per face of the caster's mesh
  RayCaster caster_;
  Eigen::AlignedBox3d box_;
};

void CastSightLines(const Tetrahedra& tetrahedra, const std::vector<SightLine>& lines, const std::vector<double>& sigma,
                    RayVotes& votes) {
  ParallelChunks(lines.size(), kGrain, [&](size_t begin, size_t end) {
    std::vector<int> around;
    int around_point = -1;
    for (size_t i = begin; i < end; ++i) {
      const int point = tetrahedra.vertex_of_point[lines[i].point];
      if (point != around_point) around = tetrahedra.CellsAround(point);
      around_point = point;
      const Eigen::Vector3d to_eye = lines[i].eye - tetrahedra.points[point];
      const double distance = to_eye.norm();
      if (!(distance > 0)) continue;
      const Eigen::Vector3d direction = to_eye / distance;
      const double s = sigma[lines[i].point];
      const int last =
          FollowFromPoint(tetrahedra, around, point, direction, distance, [&](int cell, int facet, double t) {
            const double soft = s > 0 ? 1 - std::exp(-t * t / (2 * s * s)) : 1;
            const int64_t vote = std::llround(soft * kVote);
            Add(votes.facets[cell][facet], vote);
            Add(votes.crossed[cell], vote);
          });
      if (last != kLost) Add(votes.outside[last], kVote);
      const int behind = FollowFromPoint(tetrahedra, around, point, -direction, 3 * s, [](int, int, double) {});
      if (behind != kLost) Add(votes.inside[behind], kVote);
    }
  });
}

void CastFreeLines(const Tetrahedra& tetrahedra, const std::vector<FreeLine>& lines, RayVotes& votes) {
  if (lines.empty()) return;
  const Hull hull(tetrahedra);
  ParallelFor(lines.size(), kGrain, [&](size_t i) {
    const Eigen::Vector3d to_eye = lines[i].eye - lines[i].from;
    const double distance = to_eye.norm();
    if (!(distance > 0)) return;
    hull.FollowLine(lines[i].from, to_eye / distance, distance, [&](int cell, int facet, double t) {
      if (t <= 0) return;
      Add(votes.facets[cell][facet], kVote);
      Add(votes.crossed[cell], kVote);
    });
  });
}

void CastMatter(const Tetrahedra& tetrahedra, const std::vector<MatterBehind>& matter, RayVotes& votes) {
  ParallelFor(matter.size(), kGrain, [&](size_t i) {
    const int point = tetrahedra.vertex_of_point[matter[i].point];
    const int cell = FollowFromPoint(tetrahedra, tetrahedra.CellsAround(point), point, matter[i].direction,
                                     matter[i].depth, [](int, int, double) {});
    if (cell != kLost) Add(votes.inside[cell], kVote);
  });
}

}  // namespace

RayVotes CastVotes(const Tetrahedra& tetrahedra, const std::vector<SightLine>& lines, const std::vector<double>& sigma,
                   const std::vector<FreeLine>& free_lines, const std::vector<MatterBehind>& matter) {
  GLINT_CHECK_EQ(sigma.size(), tetrahedra.points.size());
  const size_t num_cells = tetrahedra.cells.size();
  RayVotes votes;
  votes.outside.assign(num_cells, 0);
  votes.inside.assign(num_cells, 0);
  votes.crossed.assign(num_cells, 0);
  votes.facets.assign(num_cells, {0, 0, 0, 0});
  if (num_cells == 0) return votes;
  CastSightLines(tetrahedra, lines, sigma, votes);
  CastFreeLines(tetrahedra, free_lines, votes);
  CastMatter(tetrahedra, matter, votes);
  return votes;
}

}  // namespace glint
