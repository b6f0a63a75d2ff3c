#include "seed/changed_parts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <set>

#include "core/parallel.h"
#include "geometry/closest_point.h"
#include "geometry/self_intersections.h"
#include "sdf/signed_distance.h"
#include "seed/positive_solve.h"
#include "seed/thin_plate.h"

namespace glint {
namespace {

constexpr double kChangedRel = 0.003;  // of the diagonal
constexpr double kMarginRel = 0.012;   // what lies this close to changed parts bends with them
constexpr double kTouchRel = 0.012;    // an outline's ray this close to the surface touches it
constexpr double kMinFacing = 0.5;     // cosine of the surface's normal with the outline's, where it does
constexpr double kBendRel = 0.008;     // over which the surface bends to meet the outlines: about a lip's radius
constexpr int kPlacesARay = 33;
constexpr int kRounds = 3;
constexpr size_t kGrain = 256;

// 1 for the vertices that are off the other mesh, and for those around them.
std::vector<uint8_t> ChangedVertices(const TriangleMesh& before, const TriangleMesh& mesh, double diagonal) {
  const size_t n = mesh.vertices.size();
  std::vector<uint8_t> changed(n), near(n);
  const ClosestPointQuery query(before);
  ParallelFor(n, kGrain, [&](size_t v) { changed[v] = !query.Find(mesh.vertices[v], kChangedRel * diagonal); });
  TriangleMesh parts{mesh.vertices, {}, {}, {}, {}, {}};
  for (const Eigen::Vector3i& f : mesh.faces)
    if (changed[f[0]] || changed[f[1]] || changed[f[2]]) parts.faces.push_back(f);
  if (parts.faces.empty()) return changed;
  const ClosestPointQuery parts_query(parts);
  ParallelFor(n, kGrain,
              [&](size_t v) { near[v] = parts_query.Find(mesh.vertices[v], kMarginRel * diagonal).has_value(); });
  return near;
}

// A place of the surface that should be moved along the outline's normal until it touches the ray.
struct Touch {
  Eigen::Vector3i face;
  Eigen::Vector3d weights;
  Eigen::Vector3d target;
};

// Where the rays come nearest to the surface, if that is where it is free to move and faces as the outline does.
std::vector<Touch> Touches(const Scene& scene, const std::vector<OutlineSample>& outline, const TriangleMesh& mesh,
                           const std::vector<uint8_t>& changed, double diagonal) {
  std::vector<std::optional<Touch>> found(outline.size());
  const ClosestPointQuery query(mesh);
  ParallelFor(outline.size(), kGrain, [&](size_t i) {
    const OutlineSample& s = outline[i];
    const Eigen::Vector3d eye = scene.views[s.view].Center();
    std::optional<MeshPoint> nearest;
    Eigen::Vector3d place;
    // The ray passes outside of the object: where it is nearest, or deepest inside, it touches.
    double least = kTouchRel * diagonal;
    for (int k = 0; k < kPlacesARay; ++k) {
      const Eigen::Vector3d at = eye + (s.near + (s.far - s.near) * k / (kPlacesARay - 1)) * s.ray;
      const std::optional<MeshPoint> foot = query.Find(at, kTouchRel * diagonal);
      if (!foot) continue;
      const double outside = s.normal.dot(at - foot->point);
      const double facing = FaceNormal(mesh, foot->face).normalized().dot(s.normal);
      if (facing < kMinFacing || outside >= least) continue;
      least = outside;
      nearest = foot;
      place = at;
    }
    if (!nearest) return;
    const Eigen::Vector3i& f = mesh.faces[nearest->face];
    if (!changed[f[0]] && !changed[f[1]] && !changed[f[2]]) return;
    found[i] = {f, Barycentric(mesh.vertices[f[0]], mesh.vertices[f[1]], mesh.vertices[f[2]], nearest->point),
                nearest->point + least * s.normal};
  });
  std::vector<Touch> touches;
  for (const std::optional<Touch>& touch : found)
    if (touch) touches.push_back(*touch);
  return touches;
}

// How many cells of this size the places lie in.
size_t OccupiedCells(const std::vector<Touch>& touches, double size) {
  std::set<std::array<int64_t, 3>> cells;
  for (const Touch& touch : touches) {
    std::array<int64_t, 3> cell;
    for (int k = 0; k < 3; ++k) cell[k] = static_cast<int64_t>(std::floor(touch.target[k] / size));
    cells.insert(cell);
  }
  return cells.size();
}

// One solve; false if it came to nothing.
bool Solve(const std::vector<Touch>& touches, const std::vector<int>& unknown, int num_unknown, double bend,
           double stay, TriangleMesh& mesh) {
  const EvenLaplacian laplacian = MakeEvenLaplacian(mesh);
  const SparseMatrix plate = ThinPlate(laplacian, 1);
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::MatrixX3d right = Eigen::MatrixX3d::Zero(num_unknown, 3);
  for (int column = 0; column < plate.outerSize(); ++column)
    for (SparseMatrix::InnerIterator it(plate, column); it; ++it) {
      const int row = unknown[it.row()];
      if (row < 0) continue;
      if (unknown[column] >= 0)
        entries.emplace_back(row, unknown[column], it.value());
      else
        right.row(row) -= it.value() * mesh.vertices[column].transpose();
    }
  // Springs of so much an area let a plate of unit stiffness bend over `stay`.
  const double spring = stay > 0 ? laplacian.area / std::pow(stay, 4) : 0;
  const double pull = touches.empty() ? 0
                                      : static_cast<double>(OccupiedCells(touches, bend)) /
                                            static_cast<double>(touches.size()) / (bend * bend);
  for (size_t v = 0; v < unknown.size(); ++v) {
    if (unknown[v] < 0 || spring == 0) continue;
    entries.emplace_back(unknown[v], unknown[v], spring);
    right.row(unknown[v]) += spring * mesh.vertices[v].transpose();
  }
  for (const Touch& touch : touches)
    for (int j = 0; j < 3; ++j) {
      const int row = unknown[touch.face[j]];
      if (row < 0) continue;
      right.row(row) += pull * touch.weights[j] * touch.target.transpose();
      for (int k = 0; k < 3; ++k) {
        const double weight = pull * touch.weights[j] * touch.weights[k];
        if (const int other = unknown[touch.face[k]]; other >= 0)
          entries.emplace_back(row, other, weight);
        else
          right.row(row) -= weight * mesh.vertices[touch.face[k]].transpose();
      }
    }
  SparseMatrix system(num_unknown, num_unknown);
  system.setFromTriplets(entries.begin(), entries.end());
  const std::optional<Eigen::MatrixXd> x = SolvePositive(system, right);
  if (!x) return false;
  for (size_t v = 0; v < unknown.size(); ++v)
    if (unknown[v] >= 0) mesh.vertices[v] = x->row(unknown[v]);
  return true;
}

}  // namespace

TriangleMesh SmoothChangedParts(const Scene& scene, const std::vector<OutlineSample>& outline,
                                const TriangleMesh& before, const TriangleMesh& mesh, double stay_world) {
  const double diagonal = Diagonal(mesh);
  const std::vector<uint8_t> changed = ChangedVertices(before, mesh, diagonal);
  std::vector<int> unknown(changed.size(), -1);
  int num_unknown = 0;
  for (size_t v = 0; v < changed.size(); ++v)
    if (changed[v]) unknown[v] = num_unknown++;
  // All of it: nothing would hold it.
  if (num_unknown == 0 || static_cast<size_t>(num_unknown) == changed.size()) return mesh;
  TriangleMesh out{mesh.vertices, mesh.faces, {}, {}, {}, {}};
  for (int round = 0; round < kRounds; ++round) {
    const std::vector<Touch> touches = Touches(scene, outline, out, changed, diagonal);
    if (!Solve(touches, unknown, num_unknown, kBendRel * diagonal, stay_world, out)) return mesh;
  }
  return SelfIntersections(out, 1).empty() ? out : mesh;
}

}  // namespace glint
