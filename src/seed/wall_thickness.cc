#include "seed/wall_thickness.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/median.h"
#include "core/parallel.h"
#include "core/square.h"
#include "geometry/ray_caster.h"
#include "seed/positive_solve.h"

namespace glint {
namespace {

constexpr double kThickestRel = 0.1;  // of the diagonal
constexpr double kOffsetRel = 1e-4;   // of the diagonal: rays start this far inside
constexpr double kFacing = -0.7;      // cosine of the normals of a wall's two sides, at most
constexpr double kKnown = 0.5;        // at both sides
constexpr double kLeastShare = 0.1;   // of the surface: of a wall whose thickness is known
constexpr double kEven = 0.05;        // of the thickness: no wall is more even than this,
constexpr double kMostUneven = 0.25;  // nor a wall if it is less even than this
constexpr size_t kGrain = 256;

// From a vertex to the wall's other side.
struct Across {
  double thickness;
  Eigen::Vector3d position;  // there
  double known;              // there
  bool both_known;
};

std::vector<std::optional<Across>> LookAcross(const TriangleMesh& mesh, const std::vector<Eigen::Vector3d>& normals,
                                              const Eigen::VectorXd& known, double diagonal) {
  const RayCaster caster(mesh);
  std::vector<std::optional<Across>> across(mesh.vertices.size());
  ParallelFor(across.size(), kGrain, [&](size_t v) {
    const auto hit = caster.Intersect(mesh.vertices[v], -normals[v], kOffsetRel * diagonal, kThickestRel * diagonal);
    if (!hit || hit->normal.dot(normals[v]) > kFacing) return;
    const Eigen::Vector3i& f = mesh.faces[hit->face];
    const double there = (1 - hit->u - hit->v) * known[f[0]] + hit->u * known[f[1]] + hit->v * known[f[2]];
    across[v] = {hit->t, hit->position, there, std::min(there, known[static_cast<Eigen::Index>(v)]) > kKnown};
  });
  return across;
}

}  // namespace

std::vector<WallPlace> WallPlaces(const TriangleMesh& mesh, const std::vector<Eigen::Vector3d>& normals,
                                  const EvenLaplacian& laplacian, const Eigen::VectorXd& known, double length,
                                  double diagonal) {
  const std::vector<std::optional<Across>> across = LookAcross(mesh, normals, known, diagonal);
  Eigen::VectorXd measured = Eigen::VectorXd::Zero(known.size());
  SparseMatrix diffusion = laplacian.stiffness * (length * length / laplacian.area);
  size_t count = 0;
  for (size_t v = 0; v < across.size(); ++v) {
    if (!across[v] || !across[v]->both_known) continue;
    const auto row = static_cast<Eigen::Index>(v);
    const double belief = Square(std::min(known[row], across[v]->known));
    measured[row] = belief * across[v]->thickness;
    diffusion.coeffRef(row, row) += belief;
    ++count;
  }
  if (static_cast<double>(count) < kLeastShare * static_cast<double>(across.size())) return {};
  const std::optional<Eigen::MatrixXd> thickness = SolvePositive(diffusion, measured);
  if (!thickness) return {};
  std::vector<double> uneven;
  for (size_t v = 0; v < across.size(); ++v)
    if (across[v] && across[v]->both_known)
      uneven.push_back(std::abs(across[v]->thickness / (*thickness)(static_cast<Eigen::Index>(v), 0) - 1));
  const double scatter = std::max(1.4826 * Median(uneven), kEven);
  if (scatter > kMostUneven) return {};
  std::vector<WallPlace> places;
  for (size_t v = 0; v < across.size(); ++v) {
    if (!across[v]) continue;
    const double unknown = 1 - known[static_cast<Eigen::Index>(v)] / across[v]->known;
    if (!(unknown > 0)) continue;
    const double thick = (*thickness)(static_cast<Eigen::Index>(v), 0);
    places.push_back(
        {static_cast<int>(v), across[v]->position + thick * normals[v], scatter * thick / std::sqrt(unknown)});
  }
  return places;
}

}  // namespace glint
