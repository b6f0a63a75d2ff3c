#include "stereo/hollows.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "core/parallel.h"
#include "geometry/closest_point.h"
#include "geometry/point_index.h"
#include "sdf/field_mesh.h"
#include "sdf/signed_distance.h"
#include "stereo/sight_judge.h"

namespace glint {

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

constexpr std::array<std::array<int, 3>, 6> kAround = {
    {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}};

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
        walls_query_(walls_) {
    const Eigen::AlignedBox3d box = BoundingBox(mesh);
    diagonal_ = Diagonal(mesh);
    voxel_ = kVoxelRel * diagonal_;
    origin_ = box.min() - Eigen::Vector3d::Constant(2 * voxel_);
    for (int a = 0; a < 3; ++a) size_[a] = static_cast<int>(std::ceil(box.sizes()[a] / voxel_)) + 4;
    const size_t count = static_cast<size_t>(size_[0]) * size_[1] * size_[2];
    cells_.assign(count, Cell::kUnknown);
    for (int a = 0; a < 3; ++a) lattice_[a] = 2 * size_[a] + 1;
    spread_.assign(static_cast<size_t>(lattice_[0]) * lattice_[1] * lattice_[2], kUnmeasured);
    depth_.assign(count, 0);
  }

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
        ForNeighbors(c, [&](uint32_t n) {
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
    for (int pass = 0; pass < kSmoothingPasses; ++pass) Smooth(matter);
    DenseField field{{size_[2], size_[1], size_[0]}, std::move(matter)};
    Eigen::Affine3d world_from_index;
    world_from_index.linear() = voxel_ * Eigen::Matrix3d::Identity();
    world_from_index.linear().col(0).swap(world_from_index.linear().col(2));
    world_from_index.translation() = origin_ + Eigen::Vector3d::Constant(voxel_ / 2);
    TriangleMesh mesh = MeshOfField(field, world_from_index, 0.5);
    for (Eigen::Vector3i& f : mesh.faces) std::swap(f[0], f[1]);  // the axes' order mirrored it
    return mesh;
  }

 private:
  std::array<int, 3> Index(uint32_t c) const {
    const int x = static_cast<int>(c % size_[0]), rest = static_cast<int>(c / size_[0]);
    return {x, rest % size_[1], rest / size_[1]};
  }
  uint32_t CellAt(const std::array<int, 3>& i) const {
    return static_cast<uint32_t>(i[0] + size_[0] * (i[1] + static_cast<size_t>(size_[1]) * i[2]));
  }
  Eigen::Vector3d Center(uint32_t c) const {
    const std::array<int, 3> i = Index(c);
    return origin_ + voxel_ * Eigen::Vector3d(i[0] + 0.5, i[1] + 0.5, i[2] + 0.5);
  }
  std::optional<uint32_t> At(const Eigen::Vector3d& x) const {
    std::array<int, 3> i;
    for (int a = 0; a < 3; ++a) {
      i[a] = static_cast<int>(std::floor((x[a] - origin_[a]) / voxel_));
      if (i[a] < 0 || i[a] >= size_[a]) return std::nullopt;
    }
    return CellAt(i);
  }
  template <class Visit>
  void ForNeighbors(uint32_t c, const Visit& visit) const {
    const std::array<int, 3> i = Index(c);
    for (const auto& d : kAround) {
      const std::array<int, 3> n = {i[0] + d[0], i[1] + d[1], i[2] + d[2]};
      if (n[0] >= 0 && n[1] >= 0 && n[2] >= 0 && n[0] < size_[0] && n[1] < size_[1] && n[2] < size_[2])
        visit(CellAt(n));
    }
  }

  std::vector<uint32_t> BehindOpenFaces() const {
    std::vector<uint32_t> cells;
    for (size_t f = 0; f < open_.size(); ++f) {
      if (!open_[f]) continue;
      const Eigen::Vector3d a = mesh_.vertices[mesh_.faces[f][0]], b = mesh_.vertices[mesh_.faces[f][1]] - a,
                            c = mesh_.vertices[mesh_.faces[f][2]] - a;
      const int steps = std::max(1, static_cast<int>(std::ceil(2 * std::max(b.norm(), c.norm()) / voxel_)));
      for (int i = 0; i <= steps; ++i)
        for (int j = 0; i + j <= steps; ++j) {
          const auto cell = At(a + b * i / steps + c * j / steps - 0.75 * voxel_ * FaceNormal(mesh_, f));
          if (cell) cells.push_back(*cell);
        }
    }
    std::sort(cells.begin(), cells.end());
    cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
    return cells;
  }

  // The places that a cell is judged by: its centre and those of its sides, on a lattice of half voxels, so that the
  // surface passes none of them far off.
  std::array<size_t, 7> PlacesOf(uint32_t c) const {
    const std::array<int, 3> i = Index(c);
    const size_t dx = 1, dy = lattice_[0], dz = static_cast<size_t>(lattice_[0]) * lattice_[1];
    const size_t middle = (2 * i[0] + 1) * dx + (2 * i[1] + 1) * dy + (2 * i[2] + 1) * dz;
    return {middle, middle - dx, middle + dx, middle - dy, middle + dy, middle - dz, middle + dz};
  }
  Eigen::Vector3d PlaceAt(size_t p) const {
    const size_t x = p % lattice_[0], rest = p / lattice_[0];
    return origin_ + voxel_ / 2 *
                         Eigen::Vector3d(static_cast<double>(x), static_cast<double>(rest % lattice_[1]),
                                         static_cast<double>(rest / lattice_[1]));
  }

  void Measure(const std::vector<uint32_t>& front) {
    std::vector<size_t> todo;
    for (const uint32_t c : front)
      for (const size_t p : PlacesOf(c))
        if (spread_[p] == kUnmeasured) todo.push_back(p);
    std::sort(todo.begin(), todo.end());
    todo.erase(std::unique(todo.begin(), todo.end()), todo.end());
    ParallelFor(todo.size(), kGrain, [&](size_t i) {
      Colors colors = judge_.Through(PlaceAt(todo[i]), open_);
      spread_[todo[i]] = ColorSpread(colors, kFewestViews);
    });
  }

  Cell Kind(uint32_t c) const {
    const auto closest = distance_.FindClosest(Center(c));
    if (closest.distance > 0) return Cell::kOutside;
    if (InWall(Center(c))) return Cell::kWall;
    float least = std::numeric_limits<float>::infinity();
    for (const size_t p : PlacesOf(c)) least = std::min(least, spread_[p]);
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
      ForNeighbors(c, [&](uint32_t n) {
        if (cells_[n] != Cell::kCarved && cells_[n] != Cell::kOutside) around.push_back(n);
      });
    std::sort(around.begin(), around.end());
    around.erase(std::unique(around.begin(), around.end()), around.end());
    Lining lining;
    for (const uint32_t n : around) {
      lining.alike += cells_[n] == Cell::kAlike;
      if (cells_[n] != Cell::kWall) continue;
      lining.unseen += std::isinf(spread_of_face_[distance_.FindClosest(Center(n)).closest.face]);
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
        ForNeighbors(piece[i], [&](uint32_t n) {
          if (cells_[n] == Cell::kCarved && !seen[n]) {
            seen[n] = 1;
            piece.push_back(n);
          }
        });
      int depth = 0;
      for (const uint32_t c : piece) depth = std::max(depth, depth_[c]);
      const Lining lining = LiningOf(piece);
      if (depth * voxel_ < kMinDepthRel * diagonal_ || lining.alike < kMinAlike || lining.unseen > kMaxUnseen) continue;
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
        if (near[c]) ForNeighbors(c, [&](uint32_t n) { wider[n] = 1; });
      near = std::move(wider);
    }
    ParallelFor(near.size(), 1 << 10, [&](size_t c) {
      if (!near[c]) return;
      const Eigen::Vector3d x = Center(static_cast<uint32_t>(c));
      const bool free = cells_[c] == Cell::kUnknown || cells_[c] == Cell::kOutside;
      const auto closest = distance_.FindClosest(x);
      near[c] = free && closest.distance > 0 && open_[closest.closest.face] && !InWall(x);
    });
    return near;
  }

  // Binomial, along each axis.
  void Smooth(std::vector<float>& values) const {
    const std::array<size_t, 3> stride = {1, static_cast<size_t>(size_[0]), static_cast<size_t>(size_[0]) * size_[1]};
    for (int axis = 0; axis < 3; ++axis) {
      std::vector<float> out = values;
      ParallelFor(values.size(), 1 << 14, [&](size_t c) {
        const int i = Index(static_cast<uint32_t>(c))[axis];
        if (i > 0 && i + 1 < size_[axis])
          out[c] = 0.25F * values[c - stride[axis]] + 0.5F * values[c] + 0.25F * values[c + stride[axis]];
      });
      values = std::move(out);
    }
  }

  const Judge& judge_;
  const TriangleMesh& mesh_;
  const std::vector<float>& spread_of_face_;
  std::vector<uint8_t> open_;
  float threshold_;
  SignedDistanceQuery distance_;
  TriangleMesh walls_;  // the faces that are not open
  ClosestPointQuery walls_query_;
  double diagonal_ = 0, voxel_ = 0;
  Eigen::Vector3d origin_;
  std::array<int, 3> size_{}, lattice_{};
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
