#include "seed/rim_points.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "core/parallel.h"
#include "core/square.h"
#include "geometry/edge_topology.h"
#include "geometry/point_index.h"
#include "geometry/pseudo_normals.h"
#include "geometry/ray_caster.h"
#include "sdf/signed_distance.h"
#include "silhouette/support.h"

namespace glint {
namespace {

constexpr double kMaxIntervalRel = 0.10;  // of the diagonal: of a sample that becomes a point
constexpr double kWideIntervalRel = 0.3;  // where there are few sides
constexpr double kSagitta = 0.3;          // of an interval over it in diagonals: how far off its middle may be
constexpr double kGapRel = 0.03;          // from the sparse points
constexpr double kSpacingRel = 0.02;      // of rim points
constexpr double kReachRel = 0.025;       // of a rim point's neighbours
constexpr size_t kMinSupport = 4;
constexpr double kMinSigmaRel = 0.002;
constexpr double kDepthRel = 0.012;  // of matter behind a rim point
constexpr double kClearRel = 0.005;  // how far outside of the outline a ray is surely free
constexpr double kFitRel = 0.006;
// Of the diagonal: a hull is good to a few hundredths of it.
constexpr double kHullOutsideRel = 0.03, kHullSigmaRel = 0.03;
constexpr double kHullGapRel = 0.08, kHullSpacingRel = 0.06;
constexpr double kHullGroundRel = 0.02;  // below, it may be a shadow's
constexpr size_t kGrain = 256;

Eigen::Vector3d Contact(const Scene& scene, const OutlineSample& s) {
  return scene.views[s.view].Center() + s.depth * s.ray;
}

// Keeps points apart: a grid with cells as wide as the least distance.
class Thinner {
 public:
  explicit Thinner(double spacing) : spacing_(spacing) {}

  bool Add(const Eigen::Vector3d& x) {
    const Cell cell = CellOf(x);
    for (int64_t i = -1; i <= 1; ++i)
      for (int64_t j = -1; j <= 1; ++j)
        for (int64_t k = -1; k <= 1; ++k)
          if (const auto it = grid_.find({cell[0] + i, cell[1] + j, cell[2] + k}); it != grid_.end())
            for (const Eigen::Vector3d& y : it->second)
              if ((x - y).norm() < spacing_) return false;
    grid_[cell].push_back(x);
    return true;
  }

 private:
  using Cell = std::array<int64_t, 3>;
  Cell CellOf(const Eigen::Vector3d& x) const {
    Cell cell;
    for (int k = 0; k < 3; ++k) cell[k] = static_cast<int64_t>(std::floor(x[k] / spacing_));
    return cell;
  }

  double spacing_;
  std::map<Cell, std::vector<Eigen::Vector3d>> grid_;
};

// Samples whose places along their rays are known well, the best first.
std::vector<OutlineSample> WellKnown(const std::vector<OutlineSample>& outline, double max_interval) {
  std::vector<OutlineSample> out;
  for (const OutlineSample& s : outline)
    if (s.far - s.near <= max_interval) out.push_back(s);
  std::stable_sort(out.begin(), out.end(),
                   [](const OutlineSample& a, const OutlineSample& b) { return a.far - a.near < b.far - b.near; });
  return out;
}

}  // namespace

RimEvidence RimFromOutline(const Scene& scene, const std::vector<OutlineSample>& outline,
                           const std::vector<Eigen::Vector3d>& points, const RimOptions& options) {
  const double diagonal = options.diagonal;
  RimEvidence out;
  out.depth = kDepthRel * diagonal;
  const std::vector<OutlineSample> samples =
      WellKnown(outline, (options.few_sides ? kWideIntervalRel : kMaxIntervalRel) * diagonal);
  const OutlineNeighbors neighbors(scene, samples);
  const PointIndex sparse(points);
  Thinner thinner(kSpacingRel * diagonal);
  for (size_t i = 0; i < samples.size(); ++i) {
    const Eigen::Vector3d& place = neighbors.Place(i);
    if (!points.empty() && (points[sparse.Nearest(place, 1)[0]] - place).norm() < kGapRel * diagonal) continue;
    const Support support = neighbors.Of(i, kReachRel * diagonal);
    if (!options.few_sides && (support.samples < kMinSupport || support.views < 2)) continue;
    const Eigen::Vector3d x = place + support.offset * samples[i].normal;
    if (!thinner.Add(x)) continue;
    double sigma = support.spread / std::sqrt(static_cast<double>(support.samples));
    if (options.few_sides) sigma = std::max(sigma, kSagitta * Square(samples[i].far - samples[i].near) / diagonal);
    out.points.push_back({x, support.normal, std::max(sigma, kMinSigmaRel * diagonal)});
  }
  for (const OutlineSample& s : outline) {
    if (!options.carve) break;
    const Eigen::Vector3d eye = scene.views[s.view].Center();
    const Eigen::Vector3d beside = Contact(scene, s) + std::max(3 * s.sigma, kClearRel * diagonal) * s.normal;
    out.free_lines.push_back({beside + diagonal * (beside - eye).normalized(), eye});
  }
  return out;
}

void AddHullPoints(const TriangleMesh& hull, const TriangleMesh& shape, const std::vector<Eigen::Vector3d>& points,
                   const std::optional<Eigen::Hyperplane<double, 3>>& ground, RimEvidence& rim) {
  if (hull.empty() || points.empty()) return;
  const double diagonal = Diagonal(shape);
  const std::vector<double> outside = SignedDistance(shape, hull.vertices);
  const std::vector<Eigen::Vector3d> normals = ComputePseudoNormals(hull, BuildEdgeTopology(hull)).vertex;
  const PointIndex sparse(points);
  Thinner thinner(kHullSpacingRel * diagonal);
  for (const RimPoint& p : rim.points) thinner.Add(p.position);
  for (size_t i = 0; i < hull.vertices.size(); ++i) {
    const Eigen::Vector3d& x = hull.vertices[i];
    if (outside[i] < kHullOutsideRel * diagonal) continue;
    if (ground && ground->signedDistance(x) < kHullGroundRel * diagonal) continue;
    if ((points[sparse.Nearest(x, 1)[0]] - x).norm() < kHullGapRel * diagonal || !thinner.Add(x)) continue;
    rim.points.push_back({x, normals[i].normalized(), kHullSigmaRel * diagonal});
  }
}

double OutlineFit(const Scene& scene, const std::vector<OutlineSample>& outline, const TriangleMesh& mesh) {
  if (outline.empty() || mesh.empty()) return 1;
  const RayCaster caster(mesh);
  const double aside = kFitRel * Diagonal(mesh);
  const size_t fits = ParallelSum<size_t>(outline.size(), kGrain, 0, [&](size_t begin, size_t end) {
    size_t count = 0;
    for (size_t i = begin; i < end; ++i) {
      const Eigen::Vector3d eye = scene.views[outline[i].view].Center(), x = Contact(scene, outline[i]);
      const auto meets = [&](double offset) {
        return caster.Intersect(eye, (x + offset * outline[i].normal - eye).normalized()).has_value();
      };
      count += meets(-aside) && !meets(aside);
    }
    return count;
  });
  return static_cast<double>(fits) / static_cast<double>(outline.size());
}

}  // namespace glint
