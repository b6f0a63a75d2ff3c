#include "seed/sparse_surface.h"

#include <algorithm>
#include <array>

#include "geometry/closest_point.h"
#include "seed/cell_surface.h"
#include "seed/convex_hull.h"
#include "seed/sparse_cells.h"

namespace glint {
namespace {

constexpr int kBaseGrid = 24;         // points across the foot
constexpr double kFootHeight = 0.12;  // of the object's height: points lower than this show where its foot is
constexpr size_t kMinFootPoints = 3;
// The claim of matter on every cell, as a share of the lines of sight of a point: none, as published, unless that
// leaves many points without a surface. Few points, or those of thin walls, are corners of long cells that reach across
// the free space beside the matter; the lines through that space then take all of it away.
constexpr std::array<double, 4> kClaims = {0, 0.25, 1, 4};
constexpr double kEnoughPoints = 0.95;  // share of the object's points that the solid explains
constexpr double kManyMore = 0.1;       // of the points: what a larger claim must win
constexpr double kPoor = 0.5;           // share of the object's points that a solid explains and does not hide
constexpr double kEnoughOfAWall = 0.9;  // the same share
constexpr double kWallRel = 0.02;       // of the object's diagonal
constexpr double kBesideRel = 0.02;     // of the diagonal
constexpr size_t kMinContextViews = 3;  // two views agree on many a mismatch, and the context needs no rare points

// Where the object stands: the part of the ground below its lowest points.
class Foot {
 public:
  Foot(const Scene& scene, const ObjectChoice& choice) {
    if (!choice.ground) return;
    plane_ = choice.ground->plane;
    u_ = plane_.normal().unitOrthogonal();
    v_ = plane_.normal().cross(u_);
    double height = 0;
    for (size_t i = 0; i < scene.points.size(); ++i)
      if (choice.role[i] == PointRole::kObject)
        height = std::max(height, plane_.signedDistance(scene.points[i].position));
    std::vector<Eigen::Vector2d> low;
    for (size_t i = 0; i < scene.points.size(); ++i)
      if (choice.role[i] == PointRole::kObject &&
          plane_.signedDistance(scene.points[i].position) < kFootHeight * height)
        low.push_back(OnPlane(scene.points[i].position));
    if (low.size() < kMinFootPoints) return;
    outline_ = ConvexHull(low);
  }

  // Its outline and a grid that covers it, on the plane.
  std::vector<Eigen::Vector3d> Points() const {
    std::vector<Eigen::Vector3d> points;
    const Eigen::Vector3d origin = -plane_.offset() * plane_.normal();
    auto add = [&](const Eigen::Vector2d& at) { points.push_back(origin + at.x() * u_ + at.y() * v_); };
    Eigen::AlignedBox2d box;
    for (const Eigen::Vector2d& p : outline_) {
      box.extend(p);
      add(p);
    }
    const double step = box.isEmpty() ? 0 : box.sizes().maxCoeff() / kBaseGrid;
    for (int i = 0; step > 0 && i <= kBaseGrid; ++i)
      for (int j = 0; j <= kBaseGrid; ++j) {
        const Eigen::Vector2d at = box.min() + step * Eigen::Vector2d(i + (j % 2) * 0.5, j);
        if (DistanceToConvex(outline_, at) == 0) add(at);
      }
    return points;
  }

 private:
  Eigen::Vector2d OnPlane(const Eigen::Vector3d& x) const { return {x.dot(u_), x.dot(v_)}; }

  Eigen::Hyperplane<double, 3> plane_;
  Eigen::Vector3d u_ = Eigen::Vector3d::UnitX(), v_ = Eigen::Vector3d::UnitY();
  std::vector<Eigen::Vector2d> outline_;  // convex, counter-clockwise; empty: the object shows no foot
};

// Matter lies above the ground, and has at least one corner that is a point of the object or on its rim.
std::vector<uint8_t> Permitted(const SparseCells& cells, const ObjectChoice& choice) {
  const Tetrahedra& t = cells.tetrahedra;
  std::vector<uint8_t> permitted(t.cells.size(), 0);
  for (int c = 0; c < static_cast<int>(t.cells.size()); ++c) {
    if (t.IsInfinite(c)) continue;
    const bool object = std::any_of(t.cells[c].begin(), t.cells[c].end(), [&](int v) {
      return cells.scene_point[v] >= 0 || cells.scene_point[v] <= kFirstRimVertex;
    });
    permitted[c] = object && (!choice.ground || choice.ground->plane.signedDistance(t.Centroid(c)) > 0);
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

double MeanViews(const Scene& scene, const std::vector<SparseVertex>& vertices) {
  size_t views = 0, count = 0;
  for (const SparseVertex& v : vertices) {
    if (v.scene_point < 0) continue;
    views += scene.points[v.scene_point].observations.size();
    ++count;
  }
  return static_cast<double>(views) / static_cast<double>(std::max<size_t>(1, count));
}

// How many of the object's points the solid explains: fully those on its surface, half those within it, which more or
// better views may yet uncover, not at all those outside.
double PointsExplained(const SparseCells& cells, const std::vector<uint8_t>& labels) {
  const Tetrahedra& t = cells.tetrahedra;
  std::vector<uint8_t> matter(t.points.size(), 0), space(t.points.size(), 0);
  for (int c = 0; c < static_cast<int>(t.cells.size()); ++c)
    for (const int v : t.cells[c])
      if (v >= 0) (labels[c] ? matter : space)[v] = 1;
  double explained = 0;
  for (size_t v = 0; v < matter.size(); ++v)
    if (cells.scene_point[v] >= 0 && matter[v]) explained += space[v] ? 1 : 0.5;
  return explained;
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

// How many points' lines of sight end behind matter.
double PointsHidden(const SparseCells& cells, const std::vector<uint8_t>& labels, double views) {
  const Tetrahedra& t = cells.tetrahedra;
  int64_t votes = 0;
  for (size_t c = 0; c < labels.size(); ++c)
    for (int k = 0; k < 4 && labels[c]; ++k)
      if (!labels[t.neighbors[c][k]]) votes += cells.votes.facets[c][k];
  return static_cast<double>(votes) / static_cast<double>(kVote) / std::max(views, 1.0);
}

SparseSurface SurfaceOf(const SparseCells& cells, const std::vector<uint8_t>& labels) {
  SparseSurface out;
  std::vector<int> vertex_point;
  out.mesh = CellSurface(cells.tetrahedra, labels, &vertex_point);
  for (int p : vertex_point) out.scene_point.push_back(p >= 0 ? cells.scene_point[p] : kMiddleVertex);
  return out;
}

struct Solid {
  std::vector<uint8_t> labels;
  double explained = 0, hidden = 0;  // points
};

// The one that explains most, of those that ever larger claims give.
Solid BestSolid(const SparseCells& cells, const std::vector<uint8_t>& permitted, const CutOptions& options,
                double views, double num_points) {
  const Tetrahedra& t = cells.tetrahedra;
  Solid best;
  for (const double claim : kClaims) {
    std::vector<uint8_t> labels = CutCells(t, cells.votes, permitted, options, claim * views);
    KeepLargest(t, labels);
    FillCavities(t, labels);
    const double explained = PointsExplained(cells, labels);
    if (!best.labels.empty() && explained < best.explained + kManyMore * num_points) continue;
    best = {std::move(labels), explained, 0};
    if (explained >= kEnoughPoints * num_points) break;
  }
  best.hidden = PointsHidden(cells, best.labels, views);
  return best;
}

// Behind each of the object's points, away from the views that see it, another: the back of a thin wall. Also in
// `matter`.
void AddBacks(const Scene& scene, size_t num_object, std::vector<SparseVertex>& vertices,
              std::vector<MatterBehind>& matter) {
  Eigen::AlignedBox3d box;
  for (size_t k = 0; k < num_object; ++k) box.extend(vertices[k].position);
  const double depth = kWallRel * box.diagonal().norm();
  for (size_t k = 0; k < num_object; ++k) {
    const ScenePoint& point = scene.points[vertices[k].scene_point];
    const Eigen::Vector3d away = -TowardViews(scene, point).normalized();
    matter.push_back({static_cast<int>(k), away, depth});
    vertices.push_back({point.position + depth * away, kBackVertex, 0});
  }
}

}  // namespace

SparseSurface MakeSparseSurface(const Scene& scene, const PointReliability& reliability, const ObjectChoice& choice,
                                const CutOptions& options, const RimEvidence& rim) {
  std::vector<SparseVertex> vertices;
  std::vector<int> context;
  for (size_t i = 0; i < scene.points.size(); ++i) {
    if (choice.role[i] == PointRole::kUnused) continue;
    if (choice.role[i] == PointRole::kObject)
      vertices.push_back({scene.points[i].position, static_cast<int>(i), reliability.sigma[i]});
    else if (scene.points[i].observations.size() >= kMinContextViews)
      context.push_back(static_cast<int>(i));
  }
  const size_t num_object = vertices.size();
  for (const Eigen::Vector3d& x : Foot(scene, choice).Points()) vertices.push_back({x, kFootVertex, 0});
  std::vector<MatterBehind> matter;
  for (size_t i = 0; i < rim.points.size(); ++i) {
    matter.push_back({static_cast<int>(vertices.size()), -rim.points[i].normal, rim.depth});
    vertices.push_back({rim.points[i].position, kFirstRimVertex - static_cast<int>(i), rim.points[i].sigma});
  }
  const SparseCells cells = BuildSparseCells(scene, vertices, context, rim.free_lines, matter);
  if (cells.tetrahedra.cells.empty()) return {};
  std::vector<uint8_t> permitted = Permitted(cells, choice);
  if (options.see_through) {
    KeepLargest(cells.tetrahedra, permitted);
    SparseSurface hull = SurfaceOf(cells, permitted);
    hull.beside = PointsBeside(scene, choice, hull);
    return hull;
  }
  const double views = MeanViews(scene, vertices);
  const auto num_points = static_cast<double>(num_object);
  const Solid solid = BestSolid(cells, permitted, options, views, num_points);
  if (solid.explained - solid.hidden >= kPoor * num_points) return SurfaceOf(cells, solid.labels);
  // It is torn, or fills what many looked into: a bowl of whose outside little is known. As a wall?
  AddBacks(scene, num_object, vertices, matter);
  const SparseCells walled = BuildSparseCells(scene, vertices, context, rim.free_lines, matter);
  const Solid wall = BestSolid(walled, Permitted(walled, choice), options, views, num_points);
  const bool better = wall.explained - wall.hidden >= kEnoughOfAWall * num_points;
  return better ? SurfaceOf(walled, wall.labels) : SurfaceOf(cells, solid.labels);
}

}  // namespace glint
