#include "seed/ray_votes.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <atomic>
#include <cmath>
#include <limits>

#include "core/check.h"
#include "core/parallel.h"

namespace glint {
namespace {

constexpr size_t kGrain = 64;

void Add(int64_t& sum, int64_t vote) { std::atomic_ref<int64_t>(sum).fetch_add(vote, std::memory_order_relaxed); }

// The corner of `cell` where `point` is, if the cell lies on the side of `direction` from there; of the finite cells
// around the point exactly one does, up to rounding: `depth` says how well.
double DepthInCone(const Tetrahedra& t, int cell, int corner, const Eigen::Vector3d& direction) {
  const Eigen::Vector3d apex = t.Corner(cell, corner);
  Eigen::Matrix3d edges;
  for (int k = 0; k < 3; ++k) edges.col(k) = (t.Corner(cell, kOutwardFacet[corner][k]) - apex).normalized();
  // Cramer's rule without the division: the determinant is positive up to the corner's parity.
  const double det = edges.determinant();
  if (det == 0) return -std::numeric_limits<double>::infinity();
  const Eigen::Vector3d a = edges.col(0), b = edges.col(1), c = edges.col(2);
  const Eigen::Vector3d weights(direction.dot(b.cross(c)), direction.dot(c.cross(a)), direction.dot(a.cross(b)));
  return (weights / det).minCoeff();
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

// Walks from a corner of the triangulation along a ray; visit(cell, facet, t) at every facet that is left, and returns
// the cell at distance t_end (an infinite cell if the hull ends before).
template <class Visit>
int Walk(const Tetrahedra& tets, const std::vector<int>& around, int point, const Eigen::Vector3d& direction,
         double t_end, const Visit& visit) {
  const Eigen::Vector3d& origin = tets.points[point];
  int cell = -1, infinite = -1;
  double best = -1e-9;  // rounding: a ray along a facet belongs to either side
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
  if (cell < 0) return infinite;
  Exit exit;
  exit.facet = tets.CornerOf(cell, point);
  const Eigen::Vector3d a = tets.Corner(cell, kOutwardFacet[exit.facet][0]);
  const Eigen::Vector3d n =
      (tets.Corner(cell, kOutwardFacet[exit.facet][1]) - a).cross(tets.Corner(cell, kOutwardFacet[exit.facet][2]) - a);
  exit.t = (a - origin).dot(n) / direction.dot(n);
  for (size_t step = 0; step < tets.cells.size(); ++step) {
    if (exit.facet < 0 || !(exit.t < t_end)) return cell;
    visit(cell, exit.facet, exit.t);
    const int next = tets.neighbors[cell][exit.facet];
    if (tets.IsInfinite(next)) return next;
    int entry = 0;
    while (tets.neighbors[next][entry] != cell) ++entry;
    cell = next;
    exit = LeavingFacet(tets, cell, entry, origin, direction);
  }
  return cell;
}

}  // namespace

RayVotes CastVotes(const Tetrahedra& tetrahedra, const std::vector<SightLine>& lines, const std::vector<double>& sigma,
                   const std::vector<uint8_t>& is_solid) {
  GLINT_CHECK_EQ(sigma.size(), tetrahedra.points.size());
  GLINT_CHECK_EQ(is_solid.size(), tetrahedra.points.size());
  const size_t num_cells = tetrahedra.cells.size();
  RayVotes votes;
  votes.outside.assign(num_cells, 0);
  votes.inside.assign(num_cells, 0);
  votes.crossed.assign(num_cells, 0);
  votes.facets.assign(num_cells, {0, 0, 0, 0});
  if (num_cells == 0) return votes;
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
      const int last = Walk(tetrahedra, around, point, direction, distance, [&](int cell, int facet, double t) {
        const double soft = s > 0 ? 1 - std::exp(-t * t / (2 * s * s)) : 1;
        const int64_t vote = std::llround(soft * kVote);
        Add(votes.facets[cell][facet], vote);
        Add(votes.crossed[cell], vote);
      });
      Add(votes.outside[last], kVote);
      if (!is_solid[lines[i].point]) continue;
      const int behind = Walk(tetrahedra, around, point, -direction, 3 * s, [](int, int, double) {});
      Add(votes.inside[behind], kVote);
    }
  });
  return votes;
}

}  // namespace glint
