#include "seed/sparse_surface.h"

#include <algorithm>
#include <cmath>

#include "seed/cell_surface.h"
#include "seed/point_index.h"
#include "seed/sparse_cells.h"

namespace glint {
namespace {

constexpr double kReach = 1.0;  // object diagonals around the object: context this near carves
constexpr int kBaseGrid = 24;   // points across the hidden ground

enum class VertexKind : uint8_t { kObject, kGround, kContext };

struct Vertices {
  std::vector<SparseVertex> list;
  std::vector<VertexKind> kind;

  void Add(const SparseVertex& vertex, VertexKind k) {
    list.push_back(vertex);
    kind.push_back(k);
  }
};

Eigen::AlignedBox3d ObjectBox(const Scene& scene, const ObjectChoice& choice) {
  Eigen::AlignedBox3d box;
  for (size_t i = 0; i < scene.points.size(); ++i)
    if (choice.role[i] == PointRole::kObject) box.extend(scene.points[i].position);
  return box;
}

// A grid on the plane below the object, where no point of the ground is seen.
void AddHiddenGround(const Scene& scene, const ObjectChoice& choice, Vertices& vertices) {
  const Eigen::Hyperplane<double, 3>& plane = choice.ground->plane;
  const Eigen::Vector3d u = plane.normal().unitOrthogonal(), v = plane.normal().cross(u);
  Eigen::AlignedBox2d footprint;
  for (size_t i = 0; i < scene.points.size(); ++i)
    if (choice.role[i] == PointRole::kObject)
      footprint.extend(Eigen::Vector2d(scene.points[i].position.dot(u), scene.points[i].position.dot(v)));
  const double step = footprint.sizes().maxCoeff() / kBaseGrid;
  if (!(step > 0)) return;
  std::vector<Eigen::Vector3d> seen;
  for (size_t i = 0; i < vertices.list.size(); ++i)
    if (vertices.kind[i] == VertexKind::kGround) seen.push_back(vertices.list[i].position);
  const PointIndex index(seen);
  const Eigen::Vector3d origin = -plane.offset() * plane.normal();
  for (int i = 0; i <= kBaseGrid; ++i)
    for (int j = 0; j <= kBaseGrid; ++j) {
      const Eigen::Vector2d at = footprint.min() + step * Eigen::Vector2d(i + (j % 2) * 0.5, j);
      if (!footprint.contains(at)) continue;
      const Eigen::Vector3d x = origin + at.x() * u + at.y() * v;
      if (!seen.empty() && (seen[index.Nearest(x, 1)[0]] - x).norm() < step) continue;
      vertices.Add({x, -1, 0, false}, VertexKind::kGround);
    }
}

Vertices ChooseVertices(const Scene& scene, const PointReliability& reliability, const ObjectChoice& choice) {
  const Eigen::AlignedBox3d box = ObjectBox(scene, choice);
  const double reach = kReach * box.diagonal().norm();
  Vertices out;
  for (size_t i = 0; i < scene.points.size(); ++i) {
    if (choice.role[i] == PointRole::kUnused) continue;
    Eigen::Vector3d x = scene.points[i].position;
    if (box.exteriorDistance(x) > reach) continue;
    const bool object = choice.role[i] == PointRole::kObject;
    const bool ground = choice.ground && std::abs(choice.ground->plane.signedDistance(x)) < choice.ground->tolerance;
    if (ground && !object) x = choice.ground->plane.projection(x);
    out.Add({x, static_cast<int>(i), reliability.sigma[i], object},
            object ? VertexKind::kObject : (ground ? VertexKind::kGround : VertexKind::kContext));
  }
  if (choice.ground) AddHiddenGround(scene, choice, out);
  return out;
}

std::vector<uint8_t> Permitted(const Tetrahedra& t, const std::vector<VertexKind>& kind, const ObjectChoice& choice) {
  std::vector<uint8_t> permitted(t.cells.size(), 0);
  for (int c = 0; c < static_cast<int>(t.cells.size()); ++c) {
    if (t.IsInfinite(c)) continue;
    int object = 0, context = 0;
    for (int v : t.cells[c]) {
      object += kind[v] == VertexKind::kObject;
      context += kind[v] == VertexKind::kContext;
    }
    const bool above = !choice.ground || choice.ground->plane.signedDistance(t.Centroid(c)) > 0;
    permitted[c] = object > 0 && context == 0 && above;
  }
  return permitted;
}

// Keeps the largest piece alone, so that the mesh is one object.
void KeepLargest(const Tetrahedra& t, std::vector<uint8_t>& labels) {
  const CellComponents pieces = ConnectedCells(t, labels);
  std::vector<double> volume(pieces.count, 0.0);
  for (int c = 0; c < static_cast<int>(labels.size()); ++c)
    if (pieces.component[c] >= 0) volume[pieces.component[c]] += t.Volume(c);
  if (volume.empty()) return;
  const int largest = static_cast<int>(std::max_element(volume.begin(), volume.end()) - volume.begin());
  for (size_t c = 0; c < labels.size(); ++c) labels[c] = pieces.component[c] == largest;
}

// Space that the object encloses entirely is matter: nobody has looked in.
void FillCavities(const Tetrahedra& t, std::vector<uint8_t>& labels) {
  std::vector<uint8_t> empty(labels.size());
  for (size_t c = 0; c < labels.size(); ++c) empty[c] = 1 - labels[c];
  const CellComponents spaces = ConnectedCells(t, empty);
  std::vector<uint8_t> open(spaces.count, 0);
  for (int c = 0; c < static_cast<int>(labels.size()); ++c)
    if (spaces.component[c] >= 0 && t.IsInfinite(c)) open[spaces.component[c]] = 1;
  for (size_t c = 0; c < labels.size(); ++c)
    if (spaces.component[c] >= 0 && !open[spaces.component[c]]) labels[c] = 1;
}

}  // namespace

SparseSurface MakeSparseSurface(const Scene& scene, const PointReliability& reliability, const ObjectChoice& choice,
                                const CutOptions& options) {
  SparseSurface out;
  const Vertices vertices = ChooseVertices(scene, reliability, choice);
  const SparseCells cells = BuildSparseCells(scene, vertices.list);
  const Tetrahedra& t = cells.tetrahedra;
  if (t.cells.empty()) return out;
  std::vector<uint8_t> labels = CutCells(t, cells.votes, Permitted(t, vertices.kind, choice), options);
  KeepLargest(t, labels);
  FillCavities(t, labels);
  std::vector<int> vertex_point;
  out.mesh = CellSurface(t, labels, &vertex_point);
  for (int p : vertex_point)
    out.scene_point.push_back(vertices.kind[p] == VertexKind::kObject ? cells.scene_point[p] : -1);
  return out;
}

}  // namespace glint
