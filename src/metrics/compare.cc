#include "metrics/compare.h"

#include <algorithm>
#include <cmath>

#include "core/check.h"
#include "core/parallel.h"
#include "geometry/closest_point.h"
#include "geometry/edge_topology.h"
#include "geometry/pseudo_normals.h"
#include "metrics/surface_samples.h"

namespace glint {
namespace {

constexpr size_t kGrain = 256;

struct Nearest {
  int face;
  Eigen::Vector3d weights;  // barycentric
  double distance;          // world units
};

class NearestFinder {
 public:
  explicit NearestFinder(const TriangleMesh& mesh) : mesh_(mesh), query_(mesh) {}

  Nearest Find(const Eigen::Vector3d& x) const {
    const MeshPoint at = *query_.Find(x);
    const Eigen::Vector3i& f = mesh_.faces[at.face];
    const auto& v = mesh_.vertices;
    return {at.face, Barycentric(v[f[0]], v[f[1]], v[f[2]], at.point), std::sqrt(at.squared_distance)};
  }

 private:
  const TriangleMesh& mesh_;
  ClosestPointQuery query_;
};

// Interpolated vertex normals where the mesh has them, else the face's.
Eigen::Vector3d NormalAt(const TriangleMesh& mesh, int face, const Eigen::Vector3d& weights) {
  if (mesh.normals.size() != mesh.vertices.size()) return FaceNormal(mesh, face);
  Eigen::Vector3d n = Eigen::Vector3d::Zero();
  for (int k = 0; k < 3; ++k) n += weights[k] * mesh.normals[mesh.faces[face][k]];
  return n;
}

// The vertex normals of the mesh where it has them, else angle-weighted ones; zero where undefined.
std::vector<Eigen::Vector3d> VertexNormals(const TriangleMesh& mesh) {
  if (mesh.normals.size() == mesh.vertices.size()) return mesh.normals;
  return ComputePseudoNormals(mesh, BuildEdgeTopology(mesh)).vertex;
}

int NearestCorner(const TriangleMesh& mesh, int face, const Eigen::Vector3d& weights) {
  int corner;
  weights.maxCoeff(&corner);
  return mesh.faces[face][corner];
}

// Distances from samples of `from` to `to`. A sample whose vertex of the reference (the nearest corner at either end)
// is outside the mask is left out.
std::vector<double> SampledDistances(const TriangleMesh& from, const TriangleMesh& to, const NearestFinder& finder,
                                     int num_samples, const std::vector<uint8_t>& mask, bool mask_is_on_from) {
  const std::vector<AreaSample> samples = SampleSurface(from, num_samples);
  std::vector<double> distances(samples.size());
  ParallelFor(samples.size(), kGrain, [&](size_t i) {
    const Nearest nearest = finder.Find(samples[i].position);
    bool counts = true;
    if (!mask.empty())
      counts = mask_is_on_from ? mask[NearestCorner(from, samples[i].face, samples[i].weights)] != 0
                               : mask[NearestCorner(to, nearest.face, nearest.weights)] != 0;
    distances[i] = counts ? nearest.distance : -1;
  });
  std::erase_if(distances, [](double d) { return d < 0; });
  return distances;
}

double ShareBelow(const std::vector<double>& values, double limit) {
  if (values.empty()) return 0;
  return static_cast<double>(std::count_if(values.begin(), values.end(), [&](double d) { return d < limit; })) /
         static_cast<double>(values.size());
}

FScore ScoreAt(double threshold_rel, double diagonal, const std::vector<double>& accuracy,
               const std::vector<double>& completeness) {
  FScore score{threshold_rel, ShareBelow(accuracy, threshold_rel * diagonal),
               ShareBelow(completeness, threshold_rel * diagonal), 0};
  const double sum = score.precision + score.recall;
  score.f = sum > 0 ? 2 * score.precision * score.recall / sum : 0;
  return score;
}

void MeasureAtReferenceVertices(const TriangleMesh& mesh, const TriangleMesh& reference, const NearestFinder& finder,
                                MeshComparison& out) {
  const std::vector<Eigen::Vector3d> truth = VertexNormals(reference);
  out.reference_distance.resize(reference.vertices.size());
  out.reference_normal_deg.resize(reference.vertices.size());
  ParallelFor(reference.vertices.size(), kGrain, [&](size_t i) {
    const Nearest nearest = finder.Find(reference.vertices[i]);
    const Eigen::Vector3d n = NormalAt(mesh, nearest.face, nearest.weights);
    out.reference_distance[i] = static_cast<float>(nearest.distance);
    const bool defined = n.norm() > 0 && truth[i].norm() > 0;
    const double angle = std::atan2(n.cross(truth[i]).norm(), n.dot(truth[i]));
    out.reference_normal_deg[i] = defined ? static_cast<float>(angle * 180 / M_PI) : -1.0f;
  });
}

}  // namespace

void CompareOptions::Visit(OptionVisitor& v) {
  v.Field({.name = "num_samples", .help = "Samples on each surface for the distances", .min = 100, .max = 1e8},
          num_samples);
  v.Field({.name = "f_thresholds_rel",
           .help = "Distances at which F-scores are given",
           .unit = "fraction of the reference's diagonal",
           .min = 0,
           .max = 1},
          f_thresholds_rel);
}

ErrorStats StatsOf(std::vector<double> values) {
  ErrorStats stats;
  stats.count = values.size();
  if (values.empty()) return stats;
  std::sort(values.begin(), values.end());
  const double n = static_cast<double>(values.size());
  for (double v : values) {
    stats.mean += v / n;
    stats.rms += v * v / n;
  }
  stats.rms = std::sqrt(stats.rms);
  stats.median = values[values.size() / 2];
  stats.p95 = values[std::min(values.size() - 1, static_cast<size_t>(0.95 * n))];
  stats.max = values.back();
  return stats;
}

ErrorStats Scaled(const ErrorStats& stats, double factor) {
  return {stats.count,           stats.mean * factor, stats.rms * factor,
          stats.median * factor, stats.p95 * factor,  stats.max * factor};
}

MeshComparison CompareMeshes(const TriangleMesh& mesh, const TriangleMesh& reference, const CompareOptions& options,
                             const std::vector<uint8_t>& reference_mask, Progress& progress) {
  GLINT_CHECK(!mesh.empty());
  GLINT_CHECK(!reference.empty());
  GLINT_CHECK(reference_mask.empty() || reference_mask.size() == reference.vertices.size());
  progress.Begin("comparing", 0);
  const NearestFinder on_mesh(mesh);
  const NearestFinder on_reference(reference);
  MeshComparison out;
  out.reference_diagonal = Diagonal(reference);
  GLINT_CHECK_GT(out.reference_diagonal, 0);
  const double to_rel = 1 / out.reference_diagonal;

  const std::vector<double> accuracy =
      SampledDistances(mesh, reference, on_reference, options.num_samples, reference_mask, false);
  progress.ThrowIfCancelled();
  const std::vector<double> completeness =
      SampledDistances(reference, mesh, on_mesh, options.num_samples, reference_mask, true);
  progress.ThrowIfCancelled();
  out.accuracy = StatsOf(accuracy);
  out.completeness = StatsOf(completeness);
  out.accuracy_rel = Scaled(out.accuracy, to_rel);
  out.completeness_rel = Scaled(out.completeness, to_rel);
  out.chamfer = 0.5 * (out.accuracy.mean + out.completeness.mean);
  out.chamfer_rel = out.chamfer * to_rel;
  for (double threshold : options.f_thresholds_rel)
    out.f_scores.push_back(ScoreAt(threshold, out.reference_diagonal, accuracy, completeness));

  MeasureAtReferenceVertices(mesh, reference, on_mesh, out);
  out.mesh_distance.resize(mesh.vertices.size());
  ParallelFor(mesh.vertices.size(), kGrain, [&](size_t i) {
    out.mesh_distance[i] = static_cast<float>(on_reference.Find(mesh.vertices[i]).distance);
  });
  out.normal_deg = NormalStats(out, reference_mask);
  return out;
}

namespace {

ErrorStats MaskedStats(const std::vector<float>& values, const std::vector<uint8_t>& mask) {
  GLINT_CHECK(mask.empty() || mask.size() == values.size());
  std::vector<double> kept;
  for (size_t i = 0; i < values.size(); ++i)
    if ((mask.empty() || mask[i]) && values[i] >= 0) kept.push_back(values[i]);
  return StatsOf(std::move(kept));
}

}  // namespace

ErrorStats NormalStats(const MeshComparison& comparison, const std::vector<uint8_t>& reference_mask) {
  return MaskedStats(comparison.reference_normal_deg, reference_mask);
}

ErrorStats DistanceStatsRel(const MeshComparison& comparison, const std::vector<uint8_t>& reference_mask) {
  return Scaled(MaskedStats(comparison.reference_distance, reference_mask), 1 / comparison.reference_diagonal);
}

}  // namespace glint
