#include "seed/fair.h"

#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>

#include "core/check.h"
#include "geometry/closest_point.h"
#include "seed/remesh.h"

namespace glint {
namespace {

using Sparse = Eigen::SparseMatrix<double>;
using Triplet = Eigen::Triplet<double>;

constexpr double kMinSigmaRel = 5e-4;  // of the diagonal: no sparse point is surer than this
constexpr double kMaxCot = 10;         // slivers must not dominate

double Median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

struct Laplacian {
  Sparse stiffness;      // cotangent weights, symmetric, rows sum to zero
  Eigen::VectorXd area;  // a vertex
};

Laplacian CotanLaplacian(const TriangleMesh& mesh) {
  const int n = static_cast<int>(mesh.vertices.size());
  Laplacian out{Sparse(n, n), Eigen::VectorXd::Constant(n, 1e-300)};
  std::vector<Triplet> entries;
  for (const Eigen::Vector3i& f : mesh.faces)
    for (int k = 0; k < 3; ++k) {
      const int i = f[(k + 1) % 3], j = f[(k + 2) % 3];
      const Eigen::Vector3d a = mesh.vertices[i] - mesh.vertices[f[k]], b = mesh.vertices[j] - mesh.vertices[f[k]];
      const double area2 = a.cross(b).norm();
      out.area[f[k]] += area2 / 6;
      const double w = 0.5 * std::clamp(area2 > 0 ? a.dot(b) / area2 : kMaxCot, -kMaxCot, kMaxCot);
      entries.insert(entries.end(), {{i, j, -w}, {j, i, -w}, {i, i, w}, {j, j, w}});
    }
  out.stiffness.setFromTriplets(entries.begin(), entries.end());
  return out;
}

// Attachments in clusters count once: the number of voxels they occupy at a size where that still changes.
double EffectiveCount(const std::vector<Attachment>& attachments, double area) {
  const double cell = std::sqrt(area / std::max<double>(1, static_cast<double>(attachments.size())));
  std::vector<std::array<int64_t, 3>> voxels;
  for (const Attachment& a : attachments) {
    std::array<int64_t, 3> voxel;
    for (int k = 0; k < 3; ++k) voxel[k] = static_cast<int64_t>(std::floor(a.position[k] / cell));
    voxels.push_back(voxel);
  }
  std::sort(voxels.begin(), voxels.end());
  return static_cast<double>(std::unique(voxels.begin(), voxels.end()) - voxels.begin());
}

struct Foot {
  Eigen::Vector3i face;
  Eigen::Vector3d weights;
  double distance;
};

std::vector<Foot> FeetOf(const std::vector<Attachment>& attachments, const TriangleMesh& mesh) {
  const ClosestPointQuery query(mesh);
  std::vector<Foot> feet;
  for (const Attachment& a : attachments) {
    const MeshPoint at = *query.Find(a.position);
    const Eigen::Vector3i& f = mesh.faces[at.face];
    feet.push_back({f, Barycentric(mesh.vertices[f[0]], mesh.vertices[f[1]], mesh.vertices[f[2]], at.point),
                    std::sqrt(at.squared_distance)});
  }
  return feet;
}

// Weights 1/σ², lowered for those that disagree with most (Geman–McClure).
std::vector<double> RobustWeights(const std::vector<Attachment>& attachments, const std::vector<Foot>& feet,
                                  double min_sigma, bool trust_distances) {
  std::vector<double> distances;
  for (const Foot& f : feet) distances.push_back(f.distance);
  const double typical = std::max(1.4826 * Median(distances), min_sigma);
  std::vector<double> weights;
  for (size_t i = 0; i < feet.size(); ++i) {
    const double sigma = std::max(attachments[i].sigma, min_sigma);
    const double r = feet[i].distance / (4 * std::max(typical, sigma));
    weights.push_back(1 / (sigma * sigma) / (trust_distances ? std::pow(1 + r * r, 2) : 1));
  }
  return weights;
}

}  // namespace

void FairOptions::Visit(OptionVisitor& v) {
  v.Field({.name = "edge_rel",
           .help = "Edge length of the smooth seed",
           .unit = "fraction of the diagonal",
           .min = 1e-3,
           .max = 0.2},
          edge_rel);
  v.Field({.name = "smoothing",
           .help = "Length over which the seed's surface may bend to meet points",
           .unit = "times the spacing of the points",
           .min = 0.01,
           .max = 10},
          smoothing);
  v.Field({.name = "stay",
           .help = "Pull towards the sparse surface where there are no points, against that of the points",
           .min = 0,
           .max = 1},
          stay);
  v.Field({.name = "rounds", .help = "Solves of the fairing", .min = 1, .max = 50}, rounds);
}

TriangleMesh FairThroughPoints(const TriangleMesh& mesh, const std::vector<Attachment>& attachments,
                               const FairOptions& options) {
  GLINT_CHECK(!mesh.empty());
  const double diagonal = Diagonal(mesh);
  const TriangleMesh start = RemeshEvenly(mesh, options.edge_rel * diagonal);
  if (attachments.empty()) return start;
  TriangleMesh out = start;
  const int n = static_cast<int>(out.vertices.size());
  const double area = SurfaceArea(start);
  const double count = EffectiveCount(attachments, area);
  const double min_sigma = kMinSigmaRel * diagonal;
  for (int round = 0; round < options.rounds; ++round) {
    const Laplacian laplacian = CotanLaplacian(out);
    const std::vector<Foot> feet = FeetOf(attachments, out);
    // The first distances are those to the facets' chords: large also for good points.
    const std::vector<double> weights = RobustWeights(attachments, feet, min_sigma, round > 0);
    // Thin plate on springs of density ρw bends over ℓ = (λ/ρw)^¼; ℓ = smoothing · ρ^−½.
    const double density = count / area;
    const double spring = Median(weights);
    const double lambda = std::pow(options.smoothing, 4) * spring / density;
    const double stay = options.stay * spring * density;

    const Eigen::VectorXd inverse_area = laplacian.area.cwiseInverse();
    Sparse system = Sparse(laplacian.stiffness.transpose() * inverse_area.asDiagonal() * laplacian.stiffness) * lambda;
    std::vector<Triplet> entries;
    Eigen::MatrixX3d right = Eigen::MatrixX3d::Zero(n, 3);
    for (int v = 0; v < n; ++v) {
      entries.emplace_back(v, v, stay * laplacian.area[v]);
      right.row(v) += stay * laplacian.area[v] * start.vertices[v].transpose();
    }
    for (size_t i = 0; i < feet.size(); ++i)
      for (int j = 0; j < 3; ++j) {
        right.row(feet[i].face[j]) += weights[i] * feet[i].weights[j] * attachments[i].position.transpose();
        for (int k = 0; k < 3; ++k)
          entries.emplace_back(feet[i].face[j], feet[i].face[k], weights[i] * feet[i].weights[j] * feet[i].weights[k]);
      }
    Sparse springs(n, n);
    springs.setFromTriplets(entries.begin(), entries.end());
    system += springs;
    const Eigen::SimplicialLDLT<Sparse> solver(system);
    if (solver.info() != Eigen::Success) return out;  // singular: what stands so far is closed and sound
    const Eigen::MatrixX3d x = solver.solve(right);
    if (!x.allFinite()) return out;
    for (int v = 0; v < n; ++v) out.vertices[v] = x.row(v);
  }
  return out;
}

}  // namespace glint
