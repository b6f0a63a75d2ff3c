#include "stereo/hollows.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/parallel.h"
#include "geometry/closest_point.h"
#include "geometry/point_index.h"
#include "sdf/signed_distance.h"
#include "stereo/cell_grid.h"
#include "stereo/sight_judge.h"

namespace glint {

using internal::CellGrid;
using internal::Colors;
using internal::Judge;

namespace {

constexpr size_t kGrain = 32;
constexpr double kKnownReachRel = 0.03;  // of the diagonal: this close to a known place the surface is known
constexpr size_t kFewestKnown = 50;      // faces
constexpr double kKnownShare = 0.9;
constexpr float kLeastSpread = 0.012F;  // three levels of 255: no photographs are more alike
constexpr double kDoubtful = 1.6;       // times the spread of nine tenths of the known surface
constexpr size_t kFewestViews = 4;
constexpr double kVoxelRel = 1.0 / 160;
constexpr double kWallRel = 0.008;     // of the diagonal: no wall is thinner
constexpr double kMinDepthRel = 0.02;  // of the diagonal: less is for the refinement
constexpr double kMinAlike = 0.3;      // of the lining
constexpr double kMaxUnseen = 0.05;
constexpr int kStandOut = 4;  // voxels
constexpr int kSmoothingPasses = 5;
constexpr float kUnmeasured = -1;

struct FaceSpreads {
  std::vector<float> of_face;  // +inf: too few views
  std::vector<float> known;    // sorted
};

FaceSpreads MeasureFaces(const Judge& judge, const TriangleMesh& mesh, const std::vector<Eigen::Vector3d>& known) {
  FaceSpreads out;
  const double reach = kKnownReachRel * Diagonal(mesh);
  const PointIndex index(known);
  std::vector<uint8_t> is_known(mesh.faces.size());
  out.of_face.resize(mesh.faces.size());
  ParallelFor(mesh.faces.size(), kGrain, [&](size_t f) {
    Eigen::Vector3d x = Eigen::Vector3d::Zero();
    for (int k = 0; k < 3; ++k) x += mesh.vertices[mesh.faces[f][k]] / 3;
    Colors colors = judge.OnSurface(x, FaceNormal(mesh, f));
    out.of_face[f] = ColorSpread(colors, kFewestViews);
    is_known[f] = (known[index.Nearest(x, 1)[0]] - x).norm() < reach;
  });
  for (size_t f = 0; f < is_known.size(); ++f)
    if (is_known[f] && std::isfinite(out.of_face[f])) out.known.push_back(out.of_face[f]);
  std::sort(out.known.begin(), out.known.end());
  return out;
}

std::vector<uint8_t> DoubtfulFaces(const std::vector<float>& spread, float threshold) {
  std::vector<uint8_t> doubtful(spread.size(), 0);
  for (size_t f = 0; f < doubtful.size(); ++f) doubtful[f] = std::isfinite(spread[f]) && spread[f] > threshold;
  return doubtful;
}

enum class Cell : uint8_t { kUnknown, kOutside, kWall, kUnseen, kAlike, kCarved };

TriangleMesh Without(const TriangleMesh& mesh, const std::vector<uint8_t>& left_out) {
  TriangleMesh out{mesh.vertices, {}, {}, {}, {}, {}};
  for (size_t f = 0; f < mesh.faces.size(); ++f)
    if (!left_out[f]) out.faces.push_back(mesh.faces[f]);
  return out;
}

class Carver {
 public:
  // `spread`: of the faces.
  Carver(const Judge& judge, const TriangleMesh& mesh, const std::vector<float>& spread, std::vector<uint8_t> open,
         float threshold)
      : judge_(judge),
        mesh_(mesh),
        spread_of_face_(spread),
        open_(std::move(open)),
        threshold_(threshold),
        distance_(mesh, "auto"),
        walls_(Without(mesh, open_)),
        walls_query_(walls_),
        diagonal_(Diagonal(mesh)),
        grid_(BoundingBox(mesh), kVoxelRel * diagonal_),
        cells_(grid_.num_cells(), Cell::kUnknown),
        spread_(grid_.num_places(), kUnmeasured),
        depth_(grid_.num_cells(), 0) {}

  void Carve(const Progress& progress) {
    std::vector<uint32_t> front = BehindOpenFaces();
    for (int depth = 1; !front.empty(); ++depth) {
      progress.ThrowIfCancelled();
      Measure(front);
      ParallelFor(front.size(), kGrain, [&](size_t i) { cells_[front[i]] = Kind(front[i]); });
      std::vector<uint32_t> next;
      for (const uint32_t c : front) {
        if (cells_[c] != Cell::kCarved) continue;
        depth_[c] = depth;
        grid_.ForNeighbors(c, [&](uint32_t n) {
          if (cells_[n] == Cell::kUnknown) next.push_back(n);
        });
      }
      std::sort(next.begin(), next.end());
      next.erase(std::unique(next.begin(), next.end()), next.end());
      front = std::move(next);
    }
  }

  // Closed, oriented outward; smooth to about a voxel.
  TriangleMesh Mesh(HollowSummary& s) const {
    const std::vector<uint8_t> deep = DeepHollows(s);
    if (s.num_hollows == 0) return {};
    std::vector<float> matter(cells_.size(), 1);
    const std::vector<uint8_t> air = AirBefore(deep);
    for (uint32_t c = 0; c < cells_.size(); ++c)
      if (deep[c] || air[c]) matter[c] = 0;
    for (int pass = 0; pass < kSmoothingPasses; ++pass) grid_.Smooth(matter);
    return grid_.Mesh(std::move(matter), 0.5);
  }

 private:
  std::vector<uint32_t> BehindOpenFaces() const {
    std::vector<uint32_t> cells;
    for (size_t f = 0; f < open_.size(); ++f) {
      if (!open_[f]) continue;
      const Eigen::Vector3d a = mesh_.vertices[mesh_.faces[f][0]], b = mesh_.vertices[mesh_.faces[f][1]] - a,
                            c = mesh_.vertices[mesh_.faces[f][2]] - a;
      const int steps = std::max(1, static_cast<int>(std::ceil(2 * std::max(b.norm(), c.norm()) / grid_.cell_size())));
      for (int i = 0; i <= steps; ++i)
        for (int j = 0; i + j <= steps; ++j) {
          const auto cell =
              grid_.At(a + b * i / steps + c * j / steps - 0.75 * grid_.cell_size() * FaceNormal(mesh_, f));
          if (cell) cells.push_back(*cell);
        }
    }
    std::sort(cells.begin(), cells.end());
    cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
    return cells;
  }

  void Measure(const std::vector<uint32_t>& front) {
    std::vector<size_t> todo;
    for (const uint32_t c : front)
      for (const size_t p : grid_.PlacesOf(c))
        if (spread_[p] == kUnmeasured) todo.push_back(p);
    std::sort(todo.begin(), todo.end());
    todo.erase(std::unique(todo.begin(), todo.end()), todo.end());
    ParallelFor(todo.size(), kGrain, [&](size_t i) {
      Colors colors = judge_.Through(grid_.PlaceAt(todo[i]), open_);
      spread_[todo[i]] = ColorSpread(colors, kFewestViews);
    });
  }

  // Judged by its centre and those of its sides, so that the surface passes none of them far off.
  Cell Kind(uint32_t c) const {
    const auto closest = distance_.FindClosest(grid_.Center(c));
    if (closest.distance > 0) return Cell::kOutside;
    if (InWall(grid_.Center(c))) return Cell::kWall;
    float least = std::numeric_limits<float>::infinity();
    for (const size_t p : grid_.PlacesOf(c)) least = std::min(least, spread_[p]);
    return std::isinf(least) ? Cell::kUnseen : least > threshold_ ? Cell::kCarved : Cell::kAlike;
  }

  struct Lining {
    double alike = 0;   // the share that looks alike from all sides
    double unseen = 0;  // the share that is a wall which too few views see from outside
  };

  // The matter around a hollow. Carving through what only mirrors its surroundings finds nothing, and ends where nobody
  // sees it or at a wall. A wall that nobody sees may be none: then the surface was too wide there, as a whole.
  Lining LiningOf(const std::vector<uint32_t>& piece) const {
    std::vector<uint32_t> around;
    for (const uint32_t c : piece)
      grid_.ForNeighbors(c, [&](uint32_t n) {
        if (cells_[n] != Cell::kCarved && cells_[n] != Cell::kOutside) around.push_back(n);
      });
    std::sort(around.begin(), around.end());
    around.erase(std::unique(around.begin(), around.end()), around.end());
    Lining lining;
    for (const uint32_t n : around) {
      lining.alike += cells_[n] == Cell::kAlike;
      if (cells_[n] != Cell::kWall) continue;
      lining.unseen += std::isinf(spread_of_face_[distance_.FindClosest(grid_.Center(n)).closest.face]);
    }
    const double count = std::max<double>(1, static_cast<double>(around.size()));
    return {lining.alike / count, lining.unseen / count};
  }

  bool InWall(const Eigen::Vector3d& x) const { return walls_query_.Find(x, kWallRel * diagonal_).has_value(); }

  // 1 for the cells of hollows that are deep enough and lined.
  std::vector<uint8_t> DeepHollows(HollowSummary& s) const {
    std::vector<uint8_t> deep(cells_.size(), 0), seen(cells_.size(), 0);
    for (uint32_t start = 0; start < cells_.size(); ++start) {
      if (cells_[start] != Cell::kCarved || seen[start]) continue;
      std::vector<uint32_t> piece = {start};
      seen[start] = 1;
      for (size_t i = 0; i < piece.size(); ++i)
        grid_.ForNeighbors(piece[i], [&](uint32_t n) {
          if (cells_[n] == Cell::kCarved && !seen[n]) {
            seen[n] = 1;
            piece.push_back(n);
          }
        });
      int depth = 0;
      for (const uint32_t c : piece) depth = std::max(depth, depth_[c]);
      const Lining lining = LiningOf(piece);
      if (depth * grid_.cell_size() < kMinDepthRel * diagonal_ || lining.alike < kMinAlike ||
          lining.unseen > kMaxUnseen)
        continue;
      ++s.num_hollows;
      for (const uint32_t c : piece) deep[c] = 1;
    }
    return deep;
  }

  // 1 for cells of the air before the surface, up to kStandOut from a hollow that begins there.
  std::vector<uint8_t> AirBefore(const std::vector<uint8_t>& deep) const {
    std::vector<uint8_t> near = deep;
    for (int pass = 0; pass < kStandOut; ++pass) {
      std::vector<uint8_t> wider = near;
      for (uint32_t c = 0; c < near.size(); ++c)
        if (near[c]) grid_.ForNeighbors(c, [&](uint32_t n) { wider[n] = 1; });
      near = std::move(wider);
    }
    ParallelFor(near.size(), 1 << 10, [&](size_t c) {
      if (!near[c]) return;
      const Eigen::Vector3d x = grid_.Center(static_cast<uint32_t>(c));
      const bool free = cells_[c] == Cell::kUnknown || cells_[c] == Cell::kOutside;
      const auto closest = distance_.FindClosest(x);
      near[c] = free && closest.distance > 0 && open_[closest.closest.face] && !InWall(x);
    });
    return near;
  }

  const Judge& judge_;
  const TriangleMesh& mesh_;
  const std::vector<float>& spread_of_face_;
  std::vector<uint8_t> open_;
  float threshold_;
  SignedDistanceQuery distance_;
  TriangleMesh walls_;  // the faces that are not open
  ClosestPointQuery walls_query_;
  double diagonal_;
  CellGrid grid_;
  std::vector<Cell> cells_;
  std::vector<float> spread_;
  std::vector<int> depth_;
};

}  // namespace

TriangleMesh FindHollows(const Scene& scene, const SightColors& colors, const TriangleMesh& mesh,
                         const std::vector<Eigen::Vector3d>& known, HollowSummary* summary, Progress& progress) {
  HollowSummary unused;
  HollowSummary& s = summary ? *summary : unused;
  s = HollowSummary();
  if (known.empty()) return {};
  const Judge judge(scene, colors, mesh);
  const FaceSpreads spreads = MeasureFaces(judge, mesh, known);
  s.num_known = spreads.known.size();
  if (s.num_known < kFewestKnown) return {};
  const float usual =
      std::max(kLeastSpread, spreads.known[static_cast<size_t>(kKnownShare * static_cast<double>(s.num_known))]);
  std::vector<uint8_t> open = DoubtfulFaces(spreads.of_face, static_cast<float>(kDoubtful) * usual);
  s.num_doubtful = std::count(open.begin(), open.end(), 1);
  if (s.num_doubtful == 0) return {};
  Carver carver(judge, mesh, spreads.of_face, std::move(open), usual);
  carver.Carve(progress);
  return carver.Mesh(s);
}

}  // namespace glint
