#include "seed/fair.h"

#include <Eigen/Geometry>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "core/check.h"
#include "core/median.h"
#include "core/parallel.h"
#include "core/square.h"
#include "geometry/closest_point.h"
#include "geometry/edge_topology.h"
#include "geometry/point_index.h"
#include "geometry/pseudo_normals.h"
#include "seed/positive_solve.h"
#include "seed/remesh.h"
#include "seed/thin_plate.h"
#include "seed/wall_thickness.h"

namespace glint {
namespace {

using Triplet = Eigen::Triplet<double>;

constexpr double kMinSigmaRel = 5e-4;    // of the diagonal: no sparse point is surer than this
constexpr double kInertia = 2e-6;        // of the pull of points: keeps the system well posed
constexpr double kUnseenCosine = -0.25;  // of the normal with the ways to all cameras
constexpr double kRestLength = 1;        // spacings over which the natural curvature is even
constexpr double kMinBelief = 1e-3;      // in a curvature where nothing is known
constexpr double kFlatness = 0.1;  // belief in a flat surface, where outlines are known: what they leave open is a lid
constexpr double kStiffStart = 2.5;  // times the smoothing asked for
constexpr double kMaxGrowth =
    1.5;  // times the sparse surface's size: more is a bend that runs away where nothing holds
constexpr size_t kGrain = 256;
constexpr double kTrustedRange = 4;  // usual distances: farther attachments lose most of their weight

std::vector<Attachment> Leading(const std::vector<Attachment>& attachments) {
  std::vector<Attachment> out;
  for (const Attachment& a : attachments)
    if (!a.extra) out.push_back(a);
  return out.empty() ? attachments : out;
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

std::vector<Eigen::Vector3d> VertexNormals(const TriangleMesh& mesh) {
  std::vector<Eigen::Vector3d> normals = ComputePseudoNormals(mesh, BuildEdgeTopology(mesh)).vertex;
  for (Eigen::Vector3d& n : normals) n.normalize();
  return normals;
}

// The share of its weight that each keeps (Geman–McClure against the usual distance).
std::vector<double> Trust(const std::vector<Attachment>& attachments, const std::vector<AttachedPoint>& attached,
                          double min_sigma) {
  std::vector<double> distances;
  for (size_t i = 0; i < attached.size(); ++i)
    if (!attachments[i].extra) distances.push_back(attached[i].distance);
  const double typical = distances.empty() ? min_sigma : std::max(1.4826 * Median(distances), min_sigma);
  std::vector<double> trust;
  for (size_t i = 0; i < attached.size(); ++i) {
    const double range = kTrustedRange * attachments[i].credit * std::max(typical, attachments[i].sigma);
    const double r = attached[i].distance / range;
    trust.push_back(1 / Square(1 + r * r));
  }
  return trust;
}

// How well the surface is known at its vertices, 0 … 1: the density of the attachments, spread over `length`, against
// `density` (attachments an area).
std::optional<Eigen::VectorXd> Knowledge(const std::vector<AttachedPoint>& attached, const std::vector<double>& trust,
                                         const EvenLaplacian& laplacian, double length, double density) {
  Eigen::VectorXd deposits = Eigen::VectorXd::Zero(laplacian.stiffness.rows());
  for (size_t i = 0; i < attached.size(); ++i)
    for (int k = 0; k < 3; ++k)
      deposits[attached[i].face[k]] += trust[i] * attached[i].weights[k] / (laplacian.area * density);
  SparseMatrix spread = laplacian.stiffness * (length * length / laplacian.area);
  for (int v = 0; v < deposits.size(); ++v) spread.coeffRef(v, v) += 1;
  const std::optional<Eigen::MatrixXd> known = SolvePositive(spread, deposits);
  if (!known) return std::nullopt;
  return known->cwiseMax(0).cwiseMin(1);
}

// What L x is to be: the mean curvature normal of the surface as it stands, with the curvature diffused over `length`
// where it is known and continued from there where it is not. A plate that is bent by nature keeps the bend of its
// surroundings where no point holds it; a flat one would flatten.
std::optional<Eigen::MatrixX3d> RestCurvature(const TriangleMesh& mesh, const EvenLaplacian& laplacian, double length,
                                              const Eigen::VectorXd& known, double flatness) {
  const int n = static_cast<int>(mesh.vertices.size());
  Eigen::MatrixX3d x(n, 3);
  for (int v = 0; v < n; ++v) x.row(v) = mesh.vertices[v];
  const Eigen::MatrixX3d bend = laplacian.stiffness * x;
  const std::vector<Eigen::Vector3d> normals = VertexNormals(mesh);
  Eigen::VectorXd curvature(n);
  SparseMatrix diffusion = laplacian.stiffness * (length * length / laplacian.area);
  for (int v = 0; v < n; ++v) {
    const double belief = std::max(known[v] * known[v], kMinBelief);
    curvature[v] = belief * bend.row(v).dot(normals[v]);
    diffusion.coeffRef(v, v) += belief + flatness;
  }
  const std::optional<Eigen::MatrixXd> smooth = SolvePositive(diffusion, curvature);
  if (!smooth) return std::nullopt;
  Eigen::MatrixX3d rest(n, 3);
  for (int v = 0; v < n; ++v) rest.row(v) = (*smooth)(v, 0) * normals[v];
  return rest;
}

struct Springs {
  std::vector<Triplet> entries;
  Eigen::MatrixX3d right;

  explicit Springs(int n) : right(Eigen::MatrixX3d::Zero(n, 3)) {}

  void Hold(int vertex, const Eigen::Vector3d& at, double weight) {
    entries.emplace_back(vertex, vertex, weight);
    right.row(vertex) += weight * at.transpose();
  }
  void Attach(const AttachedPoint& point, const Eigen::Vector3d& at, double weight) {
    for (int j = 0; j < 3; ++j) {
      right.row(point.face[j]) += weight * point.weights[j] * at.transpose();
      for (int k = 0; k < 3; ++k)
        entries.emplace_back(point.face[j], point.face[k], weight * point.weights[j] * point.weights[k]);
    }
  }
};

// Holds everything hardly at all where it stands, and what faces away from every camera where the sparse surface is;
// but an object on the ground closes itself below, and what would pass the ground is held on it.
void HoldUnseen(const TriangleMesh& mesh, const ClosestPointQuery& raw, const FairContext& context, double weight,
                double stay, Springs& springs) {
  const std::vector<Eigen::Vector3d> normals = VertexNormals(mesh);
  std::vector<std::optional<Eigen::Vector3d>> unseen(mesh.vertices.size());
  if (!context.ground)
    ParallelFor(unseen.size(), kGrain, [&](size_t v) {
      const Eigen::Vector3d& x = mesh.vertices[v];
      const bool seen = std::any_of(context.eyes.begin(), context.eyes.end(), [&](const Eigen::Vector3d& eye) {
        return normals[v].dot((eye - x).normalized()) > kUnseenCosine;
      });
      if (!seen) unseen[v] = raw.Find(x)->point;
    });
  for (size_t v = 0; v < mesh.vertices.size(); ++v) {
    const Eigen::Vector3d& x = mesh.vertices[v];
    const int vertex = static_cast<int>(v);
    springs.Hold(vertex, x, kInertia * weight);
    if (context.ground && context.ground->signedDistance(x) < 0)
      springs.Hold(vertex, context.ground->projection(x), weight);
    if (unseen[v]) springs.Hold(vertex, *unseen[v], stay * weight);
  }
}

// Softer from round to round, as the options say at the end.
double SmoothingOf(const FairOptions& options, int round) {
  const int soft_rounds = 2;  // at the end
  const double left = std::max(0, options.rounds - soft_rounds - round);
  return options.smoothing * std::pow(kStiffStart, left / std::max(1, options.rounds - soft_rounds));
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
           .help = "Pull of the sparse surface on what no camera sees, against that of the points",
           .min = 0,
           .max = 1},
          stay);
  v.Field({.name = "rounds", .help = "Solves of the fairing", .min = 1, .max = 50}, rounds);
}

FairResult FairThroughPoints(const TriangleMesh& mesh, const std::vector<Attachment>& attachments,
                             const FairContext& context, const FairOptions& options) {
  GLINT_CHECK(!mesh.empty());
  const double diagonal = Diagonal(mesh), raw_area = SurfaceArea(mesh);
  const ClosestPointQuery raw(mesh);
  FairResult out{RemeshEvenly(mesh, options.edge_rel * diagonal), std::vector<double>(attachments.size(), 1.0)};
  if (attachments.empty()) return out;
  const std::vector<Attachment> leading = Leading(attachments);
  const double min_sigma = kMinSigmaRel * diagonal;
  for (int round = 0; round < options.rounds; ++round) {
    const double area = SurfaceArea(out.mesh);
    const EvenLaplacian laplacian = MakeEvenLaplacian(out.mesh);
    const std::vector<AttachedPoint> attached = AttachTo(out.mesh, attachments);
    // The first distances are those to flat facets: large also for good points.
    if (round > 0) out.trust = Trust(attachments, attached, min_sigma);
    std::vector<double> weights, leading_weights;
    for (size_t i = 0; i < attachments.size(); ++i) {
      weights.push_back(out.trust[i] / Square(std::max(attachments[i].sigma, min_sigma)));
      if (!attachments[i].extra || leading.size() == attachments.size()) leading_weights.push_back(weights.back());
    }
    // A thin plate on springs of density ρw bends over ℓ = (λ/ρw)^¼; ℓ = smoothing · ρ^−½.
    const double spring = Median(leading_weights);
    // Those that are less sure than sparse points count for less of one.
    const double share = std::min(1.0, Median(weights) / spring);
    const double count = EffectiveCount(leading, area);
    const double all = EffectiveCount(attachments, area);
    const double density = (count + share * (all - count)) / area;
    const double lambda = std::pow(SmoothingOf(options, round), 4) * spring / density;
    const int n = static_cast<int>(out.mesh.vertices.size());
    Springs springs(n);
    HoldUnseen(out.mesh, raw, context, spring * density * laplacian.area, options.stay, springs);
    for (size_t i = 0; i < attached.size(); ++i) springs.Attach(attached[i], attachments[i].position, weights[i]);
    if (round > 0) {
      const double flatness = leading.size() < attachments.size() ? kFlatness : 0;
      const double length = kRestLength / std::sqrt(all / area);
      const std::optional<Eigen::VectorXd> known = Knowledge(attached, out.trust, laplacian, length, all / area);
      if (!known) return out;  // as below
      if (context.even_walls)
        for (const WallPlace& place :
             WallPlaces(out.mesh, VertexNormals(out.mesh), laplacian, *known, length, diagonal))
          springs.Hold(place.vertex, place.position,
                       density * laplacian.area / Square(std::max(place.sigma, min_sigma)));
      const std::optional<Eigen::MatrixX3d> rest = RestCurvature(out.mesh, laplacian, length, *known, flatness);
      if (!rest) return out;
      springs.right += lambda / laplacian.area * (laplacian.stiffness * *rest);
    }
    SparseMatrix system(n, n);
    system.setFromTriplets(springs.entries.begin(), springs.entries.end());
    system += ThinPlate(laplacian, lambda);
    const std::optional<Eigen::MatrixXd> x = SolvePositive(system, springs.right);
    if (!x) return out;  // singular: what stands so far is closed and sound
    TriangleMesh next = out.mesh;
    for (int v = 0; v < n; ++v) next.vertices[v] = x->row(v);
    if (Diagonal(next) > kMaxGrowth * diagonal || SurfaceArea(next) > Square(kMaxGrowth) * raw_area) return out;
    out.mesh = std::move(next);
    if (round + 1 < options.rounds) out.mesh = RemeshEvenly(out.mesh, options.edge_rel * diagonal, 1);
  }
  out.trust = Trust(attachments, AttachTo(out.mesh, attachments), min_sigma);
  return out;
}

}  // namespace glint
