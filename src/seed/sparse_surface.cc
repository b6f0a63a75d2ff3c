#include "seed/sparse_surface.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "geometry/closest_point.h"
#include "seed/cell_surface.h"
#include "seed/foot.h"
#include "seed/solid.h"

namespace glint {
namespace {

constexpr double kPoor = 0.5;           // share of the object's points that a solid explains and does not hide
constexpr double kEnoughOfAWall = 0.9;  // the same share
constexpr double kMuchBetter = 0.5;     // or so much more of them than a solid
constexpr double kWallRel = 0.02;       // of the object's diagonal
constexpr double kBesideRel = 0.02;     // of the diagonal
constexpr size_t kMinContextViews = 3;  // two views agree on many a mismatch, and the context needs no rare points

// What the triangulation is made of.
struct Ingredients {
  std::vector<SparseVertex> vertices;  // the object's points, the ground below it, the rim
  size_t num_object = 0;
  std::vector<int> context;  // scene points beside the object
  std::vector<MatterBehind> matter;
};

Ingredients Collect(const Scene& scene, const PointReliability& reliability, const ObjectChoice& choice,
                    const RimEvidence& rim) {
  Ingredients out;
  for (size_t i = 0; i < scene.points.size(); ++i) {
    if (choice.role[i] == PointRole::kUnused) continue;
    if (choice.role[i] == PointRole::kObject)
      out.vertices.push_back({scene.points[i].position, static_cast<int>(i), reliability.sigma[i]});
    else if (scene.points[i].observations.size() >= kMinContextViews)
      out.context.push_back(static_cast<int>(i));
  }
  out.num_object = out.vertices.size();
  for (const Eigen::Vector3d& x : FootPoints(scene, choice)) out.vertices.push_back({x, kFootVertex, 0});
  for (size_t i = 0; i < rim.points.size(); ++i) {
    out.matter.push_back({static_cast<int>(out.vertices.size()), -rim.points[i].normal, rim.depth});
    out.vertices.push_back({rim.points[i].position, kFirstRimVertex - static_cast<int>(i), rim.points[i].sigma});
  }
  return out;
}

// Behind each of the object's points, away from the views that see it, another: the back of a thin wall.
void AddBacks(const Scene& scene, Ingredients& known) {
  Eigen::AlignedBox3d box;
  for (size_t k = 0; k < known.num_object; ++k) box.extend(known.vertices[k].position);
  const double depth = kWallRel * box.diagonal().norm();
  for (size_t k = 0; k < known.num_object; ++k) {
    const ScenePoint& point = scene.points[known.vertices[k].scene_point];
    const Eigen::Vector3d away = -TowardViews(scene, point).normalized();
    known.matter.push_back({static_cast<int>(k), away, depth});
    known.vertices.push_back({point.position + depth * away, kBackVertex, 0});
  }
}

double ViewsPerPoint(const Scene& scene, const Ingredients& known) {
  size_t views = 0;
  for (size_t k = 0; k < known.num_object; ++k)
    views += scene.points[known.vertices[k].scene_point].observations.size();
  return static_cast<double>(views) / static_cast<double>(std::max<size_t>(1, known.num_object));
}

// Points of the object that are no vertices of the surface but lie on it.
std::vector<int> PointsBeside(const Scene& scene, const ObjectChoice& choice, const SparseSurface& surface) {
  const ClosestPointQuery query(surface.mesh);
  const double reach = kBesideRel * Diagonal(surface.mesh);
  std::vector<uint8_t> is_vertex(scene.points.size(), 0);
  for (const int point : surface.scene_point)
    if (point >= 0) is_vertex[point] = 1;
  std::vector<int> beside;
  for (size_t i = 0; i < scene.points.size(); ++i)
    if (choice.role[i] == PointRole::kObject && !is_vertex[i] && query.Find(scene.points[i].position, reach))
      beside.push_back(static_cast<int>(i));
  return beside;
}

SparseSurface SurfaceOf(const SparseCells& cells, const std::vector<uint8_t>& labels) {
  SparseSurface out;
  std::vector<int> vertex_point;
  out.mesh = CellSurface(cells.tetrahedra, labels, &vertex_point);
  for (int p : vertex_point) out.scene_point.push_back(p >= 0 ? cells.scene_point[p] : kMiddleVertex);
  return out;
}

// All that its points span.
SparseSurface Hull(const Scene& scene, const ObjectChoice& choice, const SparseCells& cells) {
  std::vector<uint8_t> labels = Permitted(cells, choice);
  KeepLargest(cells.tetrahedra, labels);
  SparseSurface hull = SurfaceOf(cells, labels);
  hull.beside = PointsBeside(scene, choice, hull);
  return hull;
}

}  // namespace

SparseSurface MakeSparseSurface(const Scene& scene, const PointReliability& reliability, const ObjectChoice& choice,
                                const CutOptions& options, const RimEvidence& rim) {
  Ingredients known = Collect(scene, reliability, choice, rim);
  const double views = ViewsPerPoint(scene, known);
  const auto num_points = static_cast<double>(known.num_object);
  const auto triangulate = [&] {
    return BuildSparseCells(scene, known.vertices, known.context, rim.free_lines, known.matter);
  };
  const SparseCells cells = triangulate();
  if (cells.tetrahedra.cells.empty()) return {};
  if (options.see_through) return Hull(scene, choice, cells);
  const Solid solid = BestSolid(cells, choice, options, num_points, views);
  const double of_solid = (solid.explained - solid.hidden) / num_points;
  if (!rim.of_a_wall && of_solid >= kPoor) return SurfaceOf(cells, solid.labels);
  // It is torn, or fills what many looked into: a bowl of whose outside little is known. As a wall?
  AddBacks(scene, known);
  const SparseCells walled = triangulate();
  const Solid wall = BestSolid(walled, choice, options, num_points, views);
  const double of_wall = (wall.explained - wall.hidden) / num_points;
  if (of_wall < kEnoughOfAWall && of_wall < of_solid + kMuchBetter) return SurfaceOf(cells, solid.labels);
  SparseSurface out = SurfaceOf(walled, wall.labels);
  out.is_wall = true;
  return out;
}

}  // namespace glint
